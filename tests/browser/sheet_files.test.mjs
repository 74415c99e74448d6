// What goes into the studio and comes out of it with sheets: meshes, animated meshes, films, reports.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { violations } from './accessibility.mjs';
import { becomes, download, error_of, folder, new_page, open_patch, open_sheet, page, page_errors, scene_of, settled, sheets } from './sheet_page.mjs';
import { square_mesh } from './square_mesh.mjs';

// Few particles: the page is tested, not the engines.
const flat = square_mesh(4, (u, v) => [u, 1, v]);
const bent = square_mesh(4, (u, v) => [2 + Math.sin(u), 2 - Math.cos(u), v]);
const export_as = async (kind, where = page) => {
  await where.click('#export summary');
  return where.click(`#save-${kind}`);
};

// Both poses in one glTF file of triangles: the second one as the offsets of a morph target.
function morphing_mesh(from, to) {
  const floats = (points) => new Float32Array(points.flat());
  const indices = new Uint16Array(from.faces.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]));
  const parts = [floats(from.points), floats(to.points.map((point, i) => point.map((x, k) => x - from.points[i][k]))), indices];
  const views = [];
  let byteOffset = 0;
  for (const { byteLength } of parts) {
    views.push({ buffer: 0, byteOffset, byteLength });
    byteOffset += byteLength;
  }
  const bytes = Buffer.concat(parts.map((part) => Buffer.from(part.buffer)));
  const box = (points, of) => [0, 1, 2].map((k) => of(...points.map((point) => Math.fround(point[k]))));
  const count = from.points.length;
  return JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 2, targets: [{ POSITION: 1 }] }] }],
    buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }],
    bufferViews: views,
    accessors: [
      { bufferView: 0, componentType: 5126, count, type: 'VEC3', min: box(from.points, Math.min), max: box(from.points, Math.max) },
      { bufferView: 1, componentType: 5126, count, type: 'VEC3' },
      { bufferView: 2, componentType: 5123, count: indices.length, type: 'SCALAR' },
    ],
  });
}

// From an empty desk to the file, and every action counted that a hand does.
test('two meshes of one’s own become an animated mesh in six actions at most', async () => {
  let actions = 1; // ./run studio
  const mine = await new_page({ viewport: { width: 1280, height: 800 } });
  const chooser = mine.waitForEvent('filechooser');
  await mine.click('#open');
  actions++;
  await (await chooser).setFiles(['square-to-s-target.obj', 'square-to-s-start.obj'].map((name) => path.join(sheets, name)));
  actions++; // both are chosen and opened
  await becomes(mine, () => nuno_studio.app.doc.scene.name === 'square-to-s-target');
  await settled(mine);
  const coming = mine.waitForEvent('download');
  await mine.click('#export summary');
  actions++;
  await mine.click('#save-glb');
  actions++;
  const file = path.join(folder, 'mine.glb');
  await (await coming).saveAs(file);
  console.log(`${actions} actions`);
  assert.ok(actions <= 6);
  assert.equal(readFileSync(file).subarray(0, 4).toString(), 'glTF');
  assert.ok((await error_of(mine)) < 1e-2);
  await mine.context().close();
});

test('a mesh that is dropped with its morph target is thrown to it', async () => {
  const text = morphing_mesh(flat, bent);
  await page.evaluate((gltf) => {
    const files = new DataTransfer();
    files.items.add(new File([gltf], 'both poses.gltf'));
    document.getElementById('space').dispatchEvent(new DragEvent('drop', { dataTransfer: files, bubbles: true, cancelable: true }));
  }, text);
  await becomes(page, () => nuno_studio.app.doc.scene.name === 'both poses');
  await settled();
  const { target } = await scene_of();
  const off = Math.max(...target.vertices.map((point, i) => Math.hypot(...point.map((x, k) => x - bent.points[i][k]))));
  assert.ok(off < 1e-6, `${off}`);
  assert.ok((await error_of()) < 1e-2);
});

test('two poses of a mesh come out as point cache and film', async () => {
  await open_patch();
  await page.fill('#field-arrival_time', '0.4');
  await page.keyboard.press('Enter');
  await settled();
  const cache = readFileSync(await download(() => export_as('pc2')));
  assert.equal(cache.toString('latin1', 0, 11), 'POINTCACHE2');
  assert.equal(cache.readInt32LE(16), 36); // points
  const frames = cache.readInt32LE(28);
  assert.equal(frames, 25);
  // The last frame is the flight's end.
  const { final } = await page.evaluate(() => nuno_studio.app.results.native.flight);
  const at = (i, k) => cache.readFloatLE(32 + 4 * (3 * (36 * (frames - 1) + i) + k));
  final.forEach((point, i) => point.forEach((x, k) => assert.ok(Math.abs(at(i, k) - x) < 1e-5)));
  await settled();
  try {
    execFileSync('sh', ['-c', 'command -v ffmpeg && command -v rsvg-convert'], { stdio: 'ignore' });
  } catch {
    return; // no films here
  }
  assert.equal(readFileSync(await download(() => export_as('film'))).toString('latin1', 4, 8), 'ftyp');
  await settled();
});

test('a report of both engines says how much of it is made, and shows the sheet in space', async () => {
  await page.evaluate(() => {
    const bar = document.querySelector('#making progress');
    window.shares = [];
    new MutationObserver(() => bar.hasAttribute('value') && window.shares.push(bar.value)).observe(bar, { attributes: true });
  });
  const file = await download(() => export_as('report'));
  const shares = await page.evaluate(() => window.shares);
  assert.ok(shares.length > 0 && shares.every((share, i) => share > 0 && share <= 1 && share >= (shares[i - 1] ?? 0)), `${shares}`);
  await settled();
  assert.ok(await page.isHidden('#making'));
  for (const colorScheme of ['dark', 'light']) await look_at_report(file, colorScheme);
});

async function look_at_report(file, colorScheme) {
  const report = await (await page.context().browser().newContext({ colorScheme })).newPage();
  report.on('pageerror', (error) => page_errors.push(error.message));
  await report.goto(pathToFileURL(file).href);
  assert.match(await report.textContent('.scene h2'), /patch-target/);
  assert.match(await report.textContent('.scene .legend'), /Bullet/);
  const stage = report.locator('.scene .stage');
  await stage.locator('svg').waitFor();
  await stage.scrollIntoViewIfNeeded();
  const drawn = () => report.locator('canvas.sheet').evaluate((canvas) => canvas.toDataURL());
  const before = await drawn();
  const box = await stage.boundingBox();
  await report.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await report.mouse.down();
  await report.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2 + 20, { steps: 3 });
  await report.mouse.up();
  assert.ok(await drawn() !== before);
  assert.deepEqual(await violations(report), []);
  await report.context().close();
}

test('a report can be given up', async () => {
  await open_sheet('flag-to-half-pipe');
  await export_as('report');
  await page.locator('#making-end').click();
  await becomes(page, () => document.getElementById('making').hidden);
  assert.match(await page.textContent('#status'), /given up/);
  assert.ok(await page.isHidden('#trouble'));
  await settled();
  // It can be asked for again, and what else there is as well.
  assert.ok(await page.locator('#save-report').isEnabled());
  assert.equal(readFileSync(await download(() => export_as('glb'))).subarray(0, 4).toString(), 'glTF');
  await settled();
});

test('nothing went wrong on the way', () => assert.deepEqual(page_errors, []));
