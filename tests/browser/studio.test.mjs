// The studio under the pointer: draw, throw, drag, watch, try.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { becomes, curve, download, flight_of, folder, page, page_errors, patience, program, scene_of, settled, stroke } from './studio_page.mjs';

test('both shapes are drawn with the pointer, and the best throw is there', async () => {
  await page.click('#select-initial');
  await page.keyboard.press('d');
  await stroke(curve(30, (t) => [0.15 + 0.2 * t, 0.75 + 0.03 * Math.sin(6 * t)]));
  await page.click('#select-target');
  await page.click('#tool-draw');
  await stroke(curve(40, (t) => [0.6 + 0.22 * t, 0.4 + 0.12 * Math.sin(5 * t)]));
  const scene = await scene_of();
  assert.equal(scene.initial.length, 64);
  assert.equal(scene.target.length, 64);
  assert.ok(scene.initial.every(([, y]) => y < Math.min(...scene.target.map((p) => p[1])) + 1));
  const { error } = await flight_of('native');
  assert.ok(error.relative < 0.2, `error ${error.relative}`);
  assert.match(await page.textContent('#hint'), /m long, the cloth is/);
});

test('dragging the target moves it and the optimum with it', async () => {
  const before_drag = { scene: await scene_of(), flight: await flight_of('native') };
  const box = await page.locator('#stage').boundingBox();
  const grip = await page.evaluate(() => nuno_studio.view.to_screen(nuno_studio.app.doc.scene.target[30]));
  await page.evaluate(() => nuno_studio.latency.all.splice(0));
  const asked = [];
  const listen = (request) => asked.push(request.url());
  page.on('request', listen);
  await page.mouse.move(box.x + grip[0], box.y + grip[1]);
  await page.mouse.down();
  for (let i = 1; i <= 80; i++) {
    await page.mouse.move(box.x + grip[0] - i, box.y + grip[1] + 30 * Math.sin(i / 12));
    await page.waitForTimeout(16);
  }
  await becomes(page, () => nuno_studio.latency.all.length > 0); // the optimum follows the hand
  await page.mouse.up();
  page.off('request', listen);
  await settled();
  const [median, count] = await page.evaluate(() => [nuno_studio.latency.median, nuno_studio.latency.all.length]);
  console.log(`pointer move to the end of the frame with the new optimum: median ${median.toFixed(1)} ms over ${count} moves`);
  assert.ok(asked.some((url) => /optimize\?.*warm_start=/.test(url)), 'a hand gets a search about the last optimum');
  assert.doesNotMatch(asked[0], /after=|refine=|box2d|pareto_front/);
  assert.match(await page.textContent('#timing'), /drawn \d+ ms after the pointer/);
  const scene = await scene_of();
  assert.notDeepEqual(scene.target, before_drag.scene.target);
  assert.deepEqual(scene.initial, before_drag.scene.initial);
  assert.notEqual((await flight_of('native')).alpha, before_drag.flight.alpha);
  await page.keyboard.press('Control+z');
  await settled();
  assert.deepEqual((await scene_of()).target, before_drag.scene.target);
  assert.deepEqual(await flight_of('native'), before_drag.flight);
  await page.keyboard.press('Control+Shift+z');
  await settled();
  assert.deepEqual((await scene_of()).target, scene.target);
});

test('handles, keys and single points change the shape', async () => {
  const length = (line) => line.reduce((sum, p, i) => sum + (i ? Math.hypot(p[0] - line[i - 1][0], p[1] - line[i - 1][1]) : 0), 0);
  await page.keyboard.press('v');
  await page.keyboard.press('l');
  await settled();
  let scene = await scene_of();
  assert.ok(Math.abs(length(scene.target) / length(scene.initial) - 1) < 1e-5);
  const drag = async ([x, y], dx, dy) => {
    const box = await page.locator('#stage').boundingBox();
    await page.mouse.move(box.x + x, box.y + y);
    await page.mouse.down();
    await page.mouse.move(box.x + x + dx, box.y + y + dy, { steps: 5 });
    await page.mouse.up();
    await settled();
  };
  const place = (name) => page.evaluate((handle) => nuno_studio.view.handle_places(nuno_studio.app.doc.scene.target)[handle], name);
  const was = length(scene.target);
  await drag(await place('ne'), 40, -40);
  assert.ok(length((await scene_of()).target) > 1.05 * was);
  await page.keyboard.press('Control+z');
  await drag(await place('turn'), 60, 20);
  scene = await scene_of();
  assert.ok(Math.abs(length(scene.target) / was - 1) < 1e-4, 'a turn keeps the length');
  await page.keyboard.press('r');
  await settled();
  assert.deepEqual((await scene_of()).target[0], scene.target[63]);
  await page.keyboard.press('p');
  const end = await page.evaluate(() => nuno_studio.view.to_screen(nuno_studio.app.doc.scene.target[0]));
  await drag(end, -30, -20);
  assert.notDeepEqual((await scene_of()).target[0], scene.target[63]);
  assert.deepEqual((await scene_of()).target[40], [...scene.target].reverse()[40]);
  await page.keyboard.press('v');
});

test('the flight is scrubbed, played and flies on', async () => {
  const slider = await page.locator('#time').boundingBox();
  await page.mouse.click(slider.x + 0.3 * slider.width, slider.y + slider.height / 2);
  const time = await page.evaluate(() => nuno_studio.app.time);
  assert.ok(time > 0.2 && time < 0.8, `${time}`);
  await page.mouse.click(slider.x + slider.width - 9, slider.y + slider.height / 2);
  assert.match(await page.textContent('#hint'), /flies on/);
  await page.click('#play');
  await becomes(page, () => nuno_studio.app.playing && nuno_studio.app.time > 0.05);
  await page.click('#play');
  assert.equal(await page.evaluate(() => nuno_studio.app.playing), false);
});

test('engines are switched; both with one gain, and each with its own', async () => {
  await page.click('#engine-side');
  await settled();
  const [native, box2d] = [await flight_of('native'), await flight_of('box2d')];
  assert.equal(box2d.backend, 'box2d');
  assert.equal(box2d.alpha, native.alpha);
  assert.equal(await page.locator('#scores .score').count(), 2);
  await page.click('#engine-native');
  await settled();
});

test('a gain is tried along the curve, and the best is taken again', async () => {
  const best = await flight_of('native');
  const chart = page.locator('#gain-chart');
  await chart.scrollIntoViewIfNeeded();
  const box = await chart.boundingBox();
  await page.mouse.click(box.x + 0.45 * box.width, box.y + 0.5 * box.height);
  await settled();
  const tried = await flight_of('native');
  assert.notEqual(tried.alpha, best.alpha);
  assert.ok(tried.error.mean >= best.error.mean);
  await page.click('.best >> nth=0');
  await settled();
  assert.deepEqual(await flight_of('native'), best);
});

test('a request that an older one overtook on its way is sent again', async () => {
  // As the program answers it: the older one came later and took its place.
  let asked = 0;
  const overtake = (route) => ++asked === 2 ? route.fulfill({ status: 409, json: { error: 'overtaken' } }) : route.continue();
  await page.route('**/api/simulate*', overtake);
  const box = await page.locator('#gain-chart').boundingBox();
  await page.mouse.click(box.x + 0.4 * box.width, box.y + 0.5 * box.height); // asks when down, and when up
  await settled();
  await page.unroute('**/api/simulate*', overtake);
  assert.equal(asked, 3);
  assert.equal((await flight_of('native')).alpha, await page.evaluate(() => nuno_studio.app.alpha));
  await page.keyboard.press('Enter');
  await settled();
});

test('another scene takes nothing that was asked of the one before', async () => {
  const hold = async (what) => {
    const held = [];
    let free = false;
    const keep = (route) => (free ? route.continue() : held.push(route));
    await page.route(what, keep);
    return {
      asked: async () => {
        for (const until = Date.now() + patience; !held.length; await page.waitForTimeout(20)) assert.ok(Date.now() < until);
      },
      release: async () => {
        free = true;
        await Promise.all(held.map((route) => route.continue().catch(() => {}))); // some are given up
      },
      end: () => page.unroute(what, keep),
    };
  };
  const another = () => page.evaluate(() => document.querySelector('#new').click());
  const kept = path.join(folder, 'kept.json');
  writeFileSync(kept, JSON.stringify(await scene_of()));

  // Under way: no one asks Box2D about the new scene.
  let box2d = await hold('**/api/simulate?*box2d*');
  await page.click('#engine-over');
  await box2d.asked();
  await page.click('#engine-native');
  await another();
  await box2d.release();
  await settled();
  await box2d.end();
  assert.equal(await page.evaluate(() => nuno_studio.app.results.box2d?.key), undefined);

  // Waiting: for Box2D's answer, while a gain is tried; the new scene has no best gain yet.
  await page.click('#engine-over');
  await settled();
  box2d = await hold('**/api/simulate?*box2d*');
  await page.locator('#gain-chart').scrollIntoViewIfNeeded();
  const box = await page.locator('#gain-chart').boundingBox();
  await page.mouse.move(box.x + 0.3 * box.width, box.y + 0.5 * box.height);
  await page.mouse.down();
  for (let i = 1; i <= 10; i++) {
    await page.mouse.move(box.x + (0.3 + 0.02 * i) * box.width, box.y + 0.5 * box.height);
    await page.waitForTimeout(40);
  }
  await box2d.asked();
  const searches = await hold('**/api/optimize*');
  await another();
  await box2d.release();
  await page.waitForTimeout(300);
  const trouble = await page.evaluate(() => !document.querySelector('#trouble').hidden && document.querySelector('#trouble').textContent);
  await searches.release();
  await page.mouse.up();
  await settled();
  await box2d.end();
  await searches.end();
  assert.equal(trouble, false);

  await page.click('#engine-native');
  await page.setInputFiles('#file', kept);
  await settled();
});

test('error is traded for effort along the second curve', async () => {
  const best = await flight_of('native');
  const pareto_front = () => page.evaluate(() => nuno_studio.app.results.native.pareto_front.points);
  const chart = page.locator('#pareto-chart');
  await chart.scrollIntoViewIfNeeded();
  const box = await chart.boundingBox();
  await page.mouse.click(box.x + 0.6 * box.width, box.y + 0.5 * box.height);
  await settled();
  const tried = await flight_of('native');
  const point = (await pareto_front()).find(({ alpha }) => alpha === tried.alpha);
  assert.deepEqual([tried.error.mean, tried.control_effort], [point.error, point.control_effort]);
  assert.ok(tried.control_effort < best.control_effort && tried.error.mean > best.error.mean);
  await page.keyboard.press('ArrowLeft');
  await settled();
  const cheaper = await flight_of('native');
  assert.ok(cheaper.control_effort < tried.control_effort && cheaper.error.mean > tried.error.mean);
  await page.keyboard.press('ArrowRight');
  await settled();
  assert.deepEqual(await flight_of('native'), tried);
  await page.keyboard.press('Home');
  await settled();
  assert.equal((await flight_of('native')).control_effort, 0);
  await page.keyboard.press('End');
  await settled();
  assert.deepEqual(await flight_of('native'), best, 'the curve ends at the least error');
  await page.mouse.move(box.x + 0.9 * box.width, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 20, { steps: 8 });
  await page.mouse.up();
  await settled();
  assert.ok((await flight_of('native')).control_effort < best.control_effort);
  await page.keyboard.press('Enter');
  await settled();
  assert.deepEqual(await flight_of('native'), best);
});

test('refinement puts the cloth on the target, where the control allows it', async () => {
  const before_it = await scene_of();
  assert.ok(await page.isDisabled('#refine'));
  assert.match(await page.textContent('#refine-note'), /follows a motion/);
  await page.click('#refine-set');
  await settled();
  assert.ok(await page.isChecked('#refine'));
  const corrected = await flight_of('native');
  const out = path.join(folder, 'corrected.json');
  const saved = await download(() => page.click('#save'));
  execFileSync(program, ['optimize', '--refine', saved, '--out', out], { stdio: 'ignore' });
  const expected = JSON.parse(readFileSync(out, 'utf8'));
  assert.deepEqual([corrected.alpha, corrected.error], [expected.alpha, expected.error]);
  assert.match(await page.textContent('#refine-note'), /corrected by up to .*; without that, .* %/);
  await page.click('#export summary');
  const result = JSON.parse(readFileSync(await download(() => page.click('#save-result')), 'utf8'));
  assert.deepEqual(result.final, expected.final);
  await page.uncheck('#refine');
  await settled();
  const straight = await flight_of('native');
  assert.notEqual(straight.alpha, corrected.alpha);
  assert.ok(corrected.error.mean < straight.error.mean, `${corrected.error.mean}, ${straight.error.mean}`);
  await page.click('#engine-over');
  await settled();
  assert.ok(await page.isDisabled('#refine'));
  assert.match(await page.textContent('#refine-note'), /native engine/);
  await page.click('#engine-native');
  await page.keyboard.press('Control+z');
  await settled();
  assert.deepEqual(await scene_of(), before_it);
});

test('nothing failed on the page', () => assert.deepEqual(page_errors, []));
