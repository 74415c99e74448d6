// The studio in a real browser with real pointer input: draw, throw, drag, watch, keep.

import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';

const program = process.env.NUNO_PROGRAM;
const folder = mkdtempSync(path.join(tmpdir(), 'nuno-studio-test-'));
const patience = 120_000; // for a machine that has other work
let server, browser, page, url;
const page_errors = [];

before(async () => {
  server = spawn(program, ['studio', '--no-open', '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  url = await new Promise((resolve, reject) => {
    let said = '';
    server.stdout.on('data', (data) => {
      said += data;
      const found = said.match(/http:\/\/127\.0\.0\.1:\d+\//);
      if (found) resolve(found[0]);
    });
    server.on('exit', () => reject(new Error(`the studio ended: ${said}`)));
  });
  browser = await chromium.launch({
    executablePath: '/usr/bin/chromium',
    args: ['--headless', '--no-sandbox', '--disable-gpu', '--disable-background-networking'],
  });
  page = await new_page({ viewport: { width: 1280, height: 800 } });
});

after(async () => {
  await browser?.close();
  server?.kill('SIGINT');
  rmSync(folder, { recursive: true, force: true });
});

async function new_page(options) {
  const context = await browser.newContext({ acceptDownloads: true, ...options });
  const made = await context.newPage();
  made.setDefaultTimeout(patience);
  made.on('pageerror', (error) => page_errors.push(error.message));
  await made.goto(url);
  await settled(made);
  // The paper's control, and not landed exactly: a link that does not ask for it.
  const paper = await made.evaluate(() => ({ ...nuno_studio.app.doc.scene, reference: 'hold', damping_ratio: 0 }));
  await made.goto('about:blank');
  await made.goto(`${url}#scene=${Buffer.from(JSON.stringify(paper)).toString('base64url')}`);
  await settled(made);
  return made;
}

// The page says at once that it waits for an answer, and only when all is drawn that it does not.
async function settled(where = page) {
  await becomes(where, () => document.documentElement.dataset.busy === 'false');
}

// Not waitForFunction: it needs eval, which the page's policy forbids.
async function becomes(where, condition) {
  const until = Date.now() + patience;
  while (!(await where.evaluate(condition))) {
    assert.ok(Date.now() < until, `in vain: ${condition}`);
    await where.waitForTimeout(20);
  }
}

const scene_of = (where = page) => where.evaluate(() => nuno_studio.app.doc.scene);
const flight_of = (engine, where = page) => where.evaluate((name) => {
  const { alpha, error, backend, control_effort } = nuno_studio.app.results[name].flight;
  return { alpha, error, backend, control_effort };
}, engine);

// Along points of the stage, given in shares of its width and height.
async function stroke(points) {
  const box = await page.locator('#stage').boundingBox();
  const at = ([x, y]) => [box.x + x * box.width, box.y + y * box.height];
  await page.mouse.move(...at(points[0]));
  await page.mouse.down();
  for (const point of points.slice(1)) await page.mouse.move(...at(point));
  await page.mouse.up();
  await settled();
}
const curve = (count, f) => Array.from({ length: count }, (_, i) => f(i / (count - 1)));

async function download(act) {
  const [file] = await Promise.all([page.waitForEvent('download'), act()]);
  const to = path.join(folder, file.suggestedFilename());
  await file.saveAs(to);
  return to;
}

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

test('the answer is that of nuno optimize on the saved scene', async () => {
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

test('a phone has everything within its width', async () => {
  const phone = await new_page({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  const [wide, shown] = await phone.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(wide <= shown, `${wide} > ${shown}`);
  await phone.tap('#engine-box2d');
  await settled(phone);
  assert.equal((await flight_of('box2d', phone)).backend, 'box2d');
  // Beside is one above the other there, and each can be dragged.
  await phone.tap('#engine-side');
  await settled(phone);
  const [height, view_height, view_width, width] = await phone.evaluate(() => {
    const { view } = nuno_studio;
    return [view.height, view.view_height, view.view_width, view.width];
  });
  assert.equal(view_height, height / 2);
  assert.equal(view_width, width);
  await phone.locator('#stage').scrollIntoViewIfNeeded();
  await phone.evaluate(() => scrollTo(0, 0));
  const target = (await scene_of(phone)).target;
  const stage = await phone.locator('#stage').boundingBox();
  const [x, y] = await phone.evaluate(() => nuno_studio.view.to_screen(nuno_studio.app.doc.scene.target[32]));
  await phone.mouse.move(stage.x + x, stage.y + view_height + y);
  await phone.mouse.down();
  await phone.mouse.move(stage.x + x - 20, stage.y + view_height + y - 20, { steps: 4 });
  await phone.mouse.up();
  await settled(phone);
  const moved = (await scene_of(phone)).target;
  assert.ok(moved[0][0] < target[0][0] && moved[0][1] > target[0][1]);
  await phone.context().close();
});

test('every control has a name for a screen reader', async () => {
  const nameless = await page.evaluate(() => [...document.querySelectorAll('button, input, select, canvas')]
    .filter((e) => !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length))
    .map((e) => e.outerHTML.slice(0, 80)));
  assert.deepEqual(nameless, []);
});

test('the Tab key comes to every control', async () => {
  for (const card of ['#cloth-card', '#control-card']) await page.click(`${card} summary`);
  const wanted = await page.evaluate(() => {
    const controls = [...document.querySelectorAll('button, input, select, summary, canvas')]
      .filter((e) => e.checkVisibility({ visibilityProperty: true }) && !e.disabled && e.tabIndex >= 0);
    controls.forEach((e, i) => (e.dataset.stop = i));
    return controls.map((e) => e.id || e.textContent.trim() || e.ariaLabel);
  });
  await page.evaluate(() => document.activeElement.blur());
  const met = new Set();
  for (let i = 0; i < 2 * wanted.length; i++) {
    await page.keyboard.press('Tab');
    met.add(Number(await page.evaluate(() => document.activeElement.dataset.stop ?? -1)));
  }
  assert.deepEqual(wanted.filter((_, i) => !met.has(i)), []);
  await page.focus('#export summary');
  await page.keyboard.press('Enter');
  assert.ok(await page.isVisible('#save-film'));
  await page.keyboard.press('Escape');
  assert.ok(await page.isHidden('#save-film'));
});

test('nothing failed on the page', () => assert.deepEqual(page_errors, []));
