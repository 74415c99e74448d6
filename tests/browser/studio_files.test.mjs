// What the studio saves, opens and exports.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { curve, download, flight_of, folder, new_page, page, page_errors, program, scene_of, settled, stroke } from './studio_page.mjs';

test('the answer is that of nuno optimize on the saved scene', async () => {
  await page.click('#select-target');
  await page.click('#tool-draw');
  await stroke(curve(40, (t) => [0.6 + 0.22 * t, 0.4 + 0.12 * Math.sin(5 * t)]));
  await page.fill('#name', 'drawn by hand');
  await page.keyboard.press('Enter');
  const saved = await download(() => page.click('#save'));
  const out = path.join(folder, 'answer.json');
  execFileSync(program, ['optimize', saved, '--out', out], { stdio: 'ignore' });
  const expected = JSON.parse(readFileSync(out, 'utf8'));
  const shown = await flight_of('native');
  assert.equal(shown.alpha, expected.alpha);
  assert.deepEqual(shown.error, expected.error);
  await page.click('#export summary');
  const result = JSON.parse(readFileSync(await download(() => page.click('#save-result')), 'utf8'));
  assert.equal(result.alpha, expected.alpha);
  assert.deepEqual(result.final, expected.final);
});

test('a reload loses nothing; a saved scene opens as it was', async () => {
  const scene = await scene_of();
  const flight = await flight_of('native');
  await page.reload();
  await settled();
  assert.deepEqual(await scene_of(), scene);
  assert.deepEqual(await flight_of('native'), flight);
  const saved = path.join(folder, 'drawn by hand.json');
  await page.click('#new');
  await settled();
  assert.notDeepEqual((await scene_of()).target, scene.target);
  await page.setInputFiles('#file', saved);
  await settled();
  assert.deepEqual(await scene_of(), scene);
  assert.deepEqual(await flight_of('native'), flight);
  // The address alone is enough for another browser.
  const other = await new_page({ viewport: { width: 1280, height: 800 } });
  await other.goto(page.url());
  await other.reload();
  await settled(other);
  assert.deepEqual(await scene_of(other), scene);
  await other.context().close();
});

const has = (name) => {
  try {
    execFileSync('sh', ['-c', `command -v ${name}`], { stdio: 'ignore' });
    return true;
  } catch {
    return false;
  }
};
const films = has('ffmpeg') && has('rsvg-convert');
test('a film says how much of it is made', { skip: !films && 'no ffmpeg or rsvg-convert' }, async () => {
  await page.evaluate(() => {
    const bar = document.querySelector('#making progress');
    window.film_shares = [];
    new MutationObserver(() => bar.hasAttribute('value') && window.film_shares.push(bar.value))
      .observe(bar, { attributes: true });
  });
  const scene = await scene_of();
  await page.fill('#field-arrival_time', '0.3'); // a short one
  await page.keyboard.press('Enter');
  await settled();
  await page.click('#export summary');
  const film = readFileSync(await download(() => page.click('#save-film')));
  assert.equal(film.toString('latin1', 4, 8), 'ftyp');
  const shares = await page.evaluate(() => window.film_shares);
  assert.ok(shares.length > 0 && shares.every((share, i) => share > 0 && share <= 1 && share >= (shares[i - 1] ?? 0)), `${shares}`);
  await settled();
  assert.ok(await page.isHidden('#making'));
  await page.click('#undo');
  await settled();
  assert.deepEqual(await scene_of(), scene);
});

test('a bad scene is refused in the words of the command line', async () => {
  const scene = await scene_of();
  const bad = path.join(folder, 'bad.json');
  writeFileSync(bad, JSON.stringify({ ...scene, cloth: { ...scene.cloth, mass: -1 } }));
  await page.setInputFiles('#file', bad);
  await page.locator('#trouble').waitFor({ state: 'visible' });
  assert.match(await page.textContent('#trouble'), /\/cloth\/mass: -1 is not > 0/);
  assert.deepEqual(await scene_of(), scene);
});

test('nothing failed on the page', () => assert.deepEqual(page_errors, []));
