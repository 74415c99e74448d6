// Sheets in the studio, in a real browser with real pointer input: open, drag, look around, save.

import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { violations } from './accessibility.mjs';
import { becomes, error_of, folder, new_page, open_patch, open_sheet, page, page_errors, scene_of, settled, sheets } from './sheet_page.mjs';

const middle_of = (points) => [0, 1, 2].map((k) => points.reduce((sum, point) => sum + point[k], 0) / points.length);

// Where a point of the gizmo is on the page, in shares of its size from the middle.
const gizmo_at = (direction) => page.evaluate(([x, y, z]) => {
  const { handle, camera, gizmo } = nuno_studio.space.space;
  const far = handle.position.distanceTo(camera.position) * gizmo.size / 7;
  const place = handle.position.clone();
  place.x += x * far;
  place.y += y * far;
  place.z += z * far;
  place.project(camera);
  const box = document.getElementById('space').getBoundingClientRect();
  return [box.x + ((place.x + 1) / 2) * box.width, box.y + ((1 - place.y) / 2) * box.height];
}, direction);

async function drag([x, y], [dx, dy], button = 'left') {
  await page.mouse.move(x - 1, y);
  await page.mouse.move(x, y);
  await page.mouse.down({ button });
  for (let i = 1; i <= 8; i++) await page.mouse.move(x + (dx * i) / 8, y + (dy * i) / 8);
  await page.mouse.up({ button });
  await settled();
}

test('the first visit shows three steps, and only the first', async () => {
  assert.equal(await page.locator('#first li').count(), 3);
  assert.ok(await page.isVisible('#first'));
  await page.click('#first-done');
  await page.reload();
  await settled();
  assert.ok(await page.isHidden('#first'));
});

test('the gallery has chains and sheets, and a sheet lands on its target', async () => {
  await open_sheet('flag-to-half-pipe');
  assert.ok(await page.isVisible('#space'));
  assert.ok(await page.isHidden('#stage'));
  assert.ok((await error_of()) < 1e-3);
  assert.match(await page.textContent('.score .what'), /size/);
});

test('the gizmo moves, turns and scales the target, and the throw follows', async () => {
  await open_patch();
  const before_move = (await scene_of()).target.vertices;
  await drag(await gizmo_at([0, 0, 0]), [-60, -40]);
  const moved = (await scene_of()).target.vertices;
  const [from, to] = [middle_of(before_move), middle_of(moved)];
  assert.ok(Math.hypot(...to.map((x, k) => x - from[k])) > 0.1);
  // Moved, and not turned.
  moved.forEach((point, i) => point.forEach((x, k) => assert.ok(Math.abs(x - before_move[i][k] - (to[k] - from[k])) < 1e-5)));
  const end = await page.evaluate(() => nuno_studio.app.results.native.flight.target);
  assert.ok(Math.abs(middle_of(end)[0] - to[0]) < 1e-3); // it is fitted, about its mass centre, by less than a hundredth
  assert.ok((await error_of()) < 1e-2);

  await page.keyboard.press('t');
  await drag(await gizmo_at([0.5, 0, 0.866]), [70, 0]);
  const turned = (await scene_of()).target.vertices;
  assert.ok(JSON.stringify(turned) !== JSON.stringify(moved));
  const length = (points) => Math.hypot(...points[0].map((x, k) => x - points[1][k]));
  assert.ok(Math.abs(length(turned) - length(moved)) < 1e-5);

  await page.keyboard.press('s');
  await drag(await gizmo_at([0, 1.1, 0]), [0, -40]); // the box beyond the end of an axis scales all three
  const scaled = (await scene_of()).target.vertices;
  assert.ok(Math.abs(length(scaled) / length(turned) - 1) > 0.02);

  for (let i = 0; i < 3; i++) {
    await page.click('#undo');
    await settled();
  }
  assert.ok(JSON.stringify((await scene_of()).target.vertices) === JSON.stringify(before_move));
});

test('keys move the target, too', async () => {
  await page.keyboard.press('v');
  await page.focus('#space');
  const before_move = middle_of((await scene_of()).target.vertices);
  await page.keyboard.press('ArrowUp');
  await page.keyboard.press('PageUp');
  await settled();
  const after_move = middle_of((await scene_of()).target.vertices);
  assert.ok(after_move[1] > before_move[1] + 1e-3);
  assert.ok(after_move[2] < before_move[2] - 1e-3);
});

test('the view turns, zooms and pans, and the scene stays', async () => {
  const camera = () => page.evaluate(() => {
    const { camera, orbit } = nuno_studio.space.space;
    return { at: camera.position.toArray(), target: orbit.target.toArray(), far: camera.position.distanceTo(orbit.target) };
  });
  const text = JSON.stringify(await scene_of());
  const box = await page.locator('#space').boundingBox();
  const free = [box.x + 0.15 * box.width, box.y + 0.85 * box.height];
  const first = await camera();
  await drag(free, [80, -10]);
  const turned = await camera();
  assert.notDeepEqual(turned.at, first.at);
  assert.deepEqual(turned.target, first.target);
  await page.mouse.wheel(0, 300);
  await page.waitForTimeout(100);
  const zoomed = await camera();
  assert.ok(zoomed.far > turned.far * 1.02);
  await drag(free, [30, 20], 'right');
  assert.notDeepEqual((await camera()).target, zoomed.target);
  await page.keyboard.press('0');
  assert.ok(JSON.stringify(await scene_of()) === text);
});

test('wireframe, error by color and forces are shown on request', async () => {
  await page.evaluate(() => {
    const slider = document.getElementById('time');
    slider.value = 300;
    slider.dispatchEvent(new Event('input'));
  });
  const shown = () => page.evaluate(() => {
    const { cloths, arrows } = nuno_studio.space.space;
    return { faces: cloths[0].meshes[0].visible, arrows: arrows.visible, colored: cloths[0].front.vertexColors };
  });
  const plain = await shown();
  assert.deepEqual([plain.faces, plain.arrows, plain.colored], [true, false, 0]);
  for (const name of ['#wires', '#errors', '#forces']) await page.click(name);
  await page.waitForTimeout(100);
  const all = await shown();
  assert.equal(all.faces, false);
  assert.equal(all.arrows, true);
  assert.notEqual(all.colored, 0);
  assert.match(await page.textContent('#error-legend'), /m off/);
  for (const name of ['#wires', '#errors', '#forces']) await page.click(name);
});

test('Bullet flies over native, at its gain', async () => {
  await page.click('#engine-box2d');
  await settled();
  const flights = await page.evaluate(() => ['native', 'bullet'].map((name) => nuno_studio.app.results[name].flight.alpha));
  assert.equal(flights[0], flights[1]);
  assert.match(await page.textContent('#engine-box2d'), /Bullet/);
  await page.click('#engine-over');
  await settled();
  assert.equal(await page.locator('#scores .score').count(), 2);
  // Native's faces under Bullet's edges, or one would hide the other.
  const drawn = await page.evaluate(() => nuno_studio.space.space.cloths.map(({ group, meshes, wires, edges }) =>
    ({ faces: group.visible && meshes[0].visible, edges: wires.geometry.index.count === edges.length })));
  assert.deepEqual(drawn, [{ faces: true, edges: false }, { faces: false, edges: true }]);
  await page.click('#engine-native');
});

test('a material and sliders change the cloth', async () => {
  await page.selectOption('#material', 'silk');
  await becomes(page, () => nuno_studio.app.doc.scene.cloth.areal_density < 0.1);
  await settled();
  await page.click('#cloth-card summary');
  const before_slide = (await scene_of()).cloth.bending_stiffness;
  await page.locator('#field-cloth-bending_stiffness-sheet ~ input').focus();
  await page.keyboard.press('ArrowRight');
  await settled();
  assert.ok((await scene_of()).cloth.bending_stiffness > before_slide);
  const before_time = (await scene_of()).arrival_time;
  await page.locator('#field-arrival_time ~ input').focus();
  await page.keyboard.press('ArrowRight');
  await settled();
  const flight = await page.evaluate(() => {
    const { arrival_time } = nuno_studio.app.doc.scene;
    const { flight, curve, pareto_front } = nuno_studio.app.results.native;
    return { arrival_time, flown: flight.time_step * flight.steps, gains: curve.history.length, efforts: pareto_front.points.length };
  });
  assert.ok(flight.arrival_time > before_time);
  assert.ok(Math.abs(flight.flown - flight.arrival_time) < 1e-9);
  assert.ok(flight.gains > 10 && flight.efforts > 2, `${flight.gains}, ${flight.efforts}`); // E(α), and what less of it costs
});

test('a single mesh waits for its other pose', async () => {
  const mine = await new_page({ viewport: { width: 1280, height: 800 } });
  await mine.setInputFiles('#file', [path.join(sheets, 'square-to-s-start.obj')]);
  await becomes(mine, () => /other pose/.test(document.getElementById('trouble').textContent));
  await mine.setInputFiles('#file', [path.join(sheets, 'square-to-s-target.obj')]);
  await becomes(mine, () => nuno_studio.app.doc.scene.initial.vertices?.length === 289);
  await settled(mine);
  await mine.context().close();
});

test('where a sheet passes through itself is said', async () => {
  // A strip whose profile is a loop: it does so from the first frame on.
  const profile = [[0, 1], [1, 2], [1, 1.2], [0, 1.7]];
  const loop = (shift) => [0, 1, 2].flatMap((row) => profile.map(([x, y]) => `v ${x + shift} ${y} ${row}`)).join('\n') + '\n' +
    [0, 1].flatMap((row) => [0, 1, 2].map((k) => `f ${[k, k + 4, k + 5, k + 1].map((i) => i + 1 + 4 * row).join(' ')}`)).join('\n') + '\n';
  const names = ['loop-start.obj', 'loop-target.obj'].map((name) => path.join(folder, name));
  names.forEach((name, i) => writeFileSync(name, loop(2 * i)));
  await page.setInputFiles('#file', names);
  await becomes(page, () => nuno_studio.app.doc.scene.name === 'loop-target');
  await settled();
  assert.match(await page.textContent('#remarks'), /Passes through itself in \d+ of \d+ frames, first at 0\.00 s/);
  assert.ok(await page.evaluate(() => nuno_studio.space.space.crossed.visible));
});

test('a reload keeps the sheet', async () => {
  await open_patch();
  const text = JSON.stringify(await scene_of());
  await page.reload();
  await settled();
  assert.ok(JSON.stringify(await scene_of()) === text);
  assert.ok(await page.isVisible('#space'));
});

test('nothing of the page breaks a rule of axe-core, light and dark, with a mouse and on a phone', async () => {
  for (const options of [{ colorScheme: 'light' }, { colorScheme: 'dark' }, { viewport: { width: 390, height: 844 }, hasTouch: true }]) {
    const other = await new_page(options);
    assert.deepEqual(await violations(other), []);
    await other.click('#first-done');
    await open_patch(other);
    assert.deepEqual(await violations(other), []);
    await other.click('#export summary');
    assert.deepEqual(await violations(other), []);
    await other.click('#gallery');
    assert.deepEqual(await violations(other), []);
    await other.context().close();
  }
});

test('nothing went wrong on the way', () => assert.deepEqual(page_errors, []));
