// The report of `nuno compare`, from the disk, as a person uses it.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
import { violations } from './accessibility.mjs';

// Few particles and long steps: the page is tested, not the engines.
const scene = {
  nuno_scene: 1, name: 'small </script> & "quoted"', particles: 8, arrival_time: 0.5,
  time_step: 0.002,
  initial: [[0, 1], [1, 1]], target: [[2, 1], [2.5, 1.3], [3, 1]],
};

let folder, browser, comparison, url;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'nuno-report-'));
  const files = [0, 1, 2, 3].map((i) => {
    const file = join(folder, `scene-${i}.json`);
    const one = { ...scene, target: scene.target.map(([x, y]) => [x, y + 0.1 * i]) };
    if (i > 0) one.name = `scene ${i}`;
    writeFileSync(file, JSON.stringify(one));
    return file;
  });
  execFileSync(process.env.NUNO_PROGRAM, ['compare', ...files, '--out', folder]);
  comparison = JSON.parse(readFileSync(join(folder, 'compare.json'), 'utf8'));
  url = pathToFileURL(join(folder, 'report.html')).href;
  browser = await chromium.launch({
    executablePath: '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu'],
  });
});

after(async () => {
  await browser?.close();
  if (folder) rmSync(folder, { recursive: true });
});

/// The page in a window; every complaint of the browser's is collected, every request noted.
async function opened(options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, ...options });
  page.complaints = [];
  page.on('pageerror', (error) => page.complaints.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.complaints.push(message.text()));
  page.on('request', (request) => request.url() !== url && page.complaints.push(request.url()));
  await page.goto(url);
  await page.locator('#scene-1 [data-part="stage"] svg').waitFor();
  return page;
}

const part = (page, name, scene = 1) => page.locator(`#scene-${scene} [data-part="${name}"]`);
const shown = async (page, name, scene) => (await part(page, name, scene).textContent()).trim();

test('the page is small and asks the network for nothing', async () => {
  assert.ok(statSync(join(folder, 'report.html')).size <= 3 * 2 ** 20);
  const page = await opened();
  const loaded = await page.evaluate(
    () => performance.getEntriesByType('navigation')[0].loadEventEnd);
  console.log(`loaded after ${loaded.toFixed(0)} ms`);
  assert.deepEqual(page.complaints, []);
  assert.equal(await page.locator('.scene').count(), 4);
  assert.equal(await page.locator('#scene-1 h2').textContent(), scene.name);
  await page.close();
});

test('it plays to the arrival and stops there', async () => {
  const page = await opened();
  const cloth = page.locator('#scene-1 [data-part="stage"] polyline.thick').first();
  const end = await cloth.getAttribute('points');
  await part(page, 'speed').selectOption('0.1'); // for a browser that is busy
  await part(page, 'play').click();
  await page.waitForFunction(
    () => Number(document.querySelector('#scene-1 [data-part="time"]').value) > 0.05);
  assert.equal(await shown(page, 'play'), 'Pause');
  assert.notEqual(await cloth.getAttribute('points'), end);
  await part(page, 'speed').selectOption('1');
  await page.waitForFunction(
    () => document.querySelector('#scene-1 [data-part="clock"]').textContent.includes('arrival'));
  assert.equal(await shown(page, 'play'), 'Replay');
  assert.equal(await cloth.getAttribute('points'), end);
  assert.deepEqual(page.complaints, []);
  await page.close();
});

test('scrubbed to the arrival, it shows the errors of the comparison', async () => {
  const page = await opened();
  for (let scene = 1; scene <= 4; ++scene) {
    const { rows } = comparison.scenes[scene - 1];
    await part(page, 'time', scene).fill('0.2');
    assert.equal(await shown(page, 'clock', scene), '0.20 s');
    await part(page, 'time', scene).press('End');
    assert.equal(await shown(page, 'clock', scene), '0.50 s, arrival');
    for (const engine of [0, 1]) {
      const error = parseFloat(await shown(page, `error-${engine}`, scene));
      const length = 1; // of the cloth
      assert.ok(Math.abs(error - (100 * rows[engine].error) / length) <= 0.006,
        `${error} is not 100 · ${rows[engine].error}`);
    }
  }
  await page.close();
});

test('the cloths are drawn to scale: what they residual on the page is what it says', async () => {
  const page = await opened();
  for (let scene = 1; scene <= 4; ++scene) {
    for (const label of ['each at its own best', 'launch only']) {
      await page.locator(`#scene-${scene} .gains label`, { hasText: label }).click();
      const [target, ...cloths] = await page.evaluate((id) =>
        ['.band', '.thick.a', '.thick.b'].map((name) =>
          document.querySelector(`#${id} [data-part="stage"] polyline${name}`)
            .getAttribute('points').trim().split(' ').map((place) => place.split(',').map(Number))),
      `scene-${scene}`);
      const apart = ([x, y], [u, v]) => Math.hypot(x - u, y - v);
      const length = target.slice(1).reduce((sum, place, i) => sum + apart(place, target[i]), 0);
      for (const engine of [0, 1]) {
        const sum = target.reduce((all, place, i) => all + apart(place, cloths[engine][i]), 0);
        const measured = (100 * sum) / target.length / length;
        const said = parseFloat(await shown(page, `error-${engine}`, scene));
        // Places are written to a tenth of a pixel, of a cloth of more than a hundred.
        assert.ok(Math.abs(measured - said) < 0.08, `${measured} is not ${said}`);
      }
    }
  }
  await page.close();
});

test('another gain moves the cloths and the mark on the curve', async () => {
  const page = await opened();
  const cursor = page.locator('#scene-1 .cursor');
  const place = await cursor.getAttribute('transform');
  await page.locator('#scene-1 .gains label', { hasText: 'launch only' }).click();
  assert.notEqual(await cursor.getAttribute('transform'), place);
  const error = parseFloat(await shown(page, 'error-0'));
  const { launch_only_error: wanted } = comparison.scenes[0].rows[0];
  assert.ok(Math.abs(error - 100 * wanted) <= 0.006, `${error} is not 100 · ${wanted}`);
  await part(page, 'most').click();
  assert.ok(await page.locator('#scene-1 [data-part="stage"] circle').isVisible());
  await page.close();
});

/// The row of compare.json's curve with a gain that the page shows to three digits.
function curvePoint(shownGain, scene = 1) {
  const { alpha, native, box2d, control_effort: effort } = comparison.scenes[scene - 1].alpha_curve;
  const i = alpha.findIndex((gain) => Math.abs(gain - shownGain) <= 0.006 * gain);
  return { gain: alpha[i], errors: [native[i], box2d[i]], efforts: [effort.native[i], effort.box2d[i]] };
}

const centre = ({ x, y, width, height }) => [x + width / 2, y + height / 2];

for (const viewport of [{ width: 1280, height: 900 }, { width: 390, height: 844 }]) {
  test(`a click at a point of the pareto-front flies it, at ${viewport.width} px`, async () => {
    const page = await opened({ viewport });
    await part(page, 'pareto-front').scrollIntoViewIfNeeded();
    const dots = page.locator('#scene-1 .dots-of circle');
    const places = [];
    for (const dot of await dots.all()) places.push(centre(await dot.boundingBox()));
    assert.ok(places.length >= 5, `${places.length} points`);
    places.sort(([a], [b]) => a - b);
    for (let i = 1; i < places.length; ++i) {
      assert.ok(places[i][1] > places[i - 1][1], 'more effort, less error');
    }
    const rings = page.locator('#scene-1 .rings-of circle.a:visible');
    const ringAt = async (place) => {
      const [x, y] = centre(await rings.last().boundingBox());
      return Math.hypot(x - place[0], y - place[1]) < 1;
    };
    const before = await shown(page, 'error-0');
    // The axes are logarithmic: three points say by their readings where they must be.
    const logs = [];
    for (const place of [places[0], places[places.length >> 1], places.at(-1)]) {
      await page.mouse.click(...place);
      logs.push([Math.log(parseFloat(await shown(page, 'reading-0-2'))),
        -Math.log(parseFloat(await shown(page, 'reading-0-1'))), ...place]);
    }
    const share = (k) => (logs[1][k] - logs[0][k]) / (logs[2][k] - logs[0][k]);
    for (const k of [0, 1]) {
      assert.ok(Math.abs(share(k) - share(k + 2)) < 0.02, `${share(k)} is not ${share(k + 2)}`);
    }
    const picked = places[places.length >> 1];
    await page.mouse.click(...picked);
    const gain = parseFloat(await shown(page, 'reading-0-0'));
    const wanted = curvePoint(gain);
    for (const engine of [0, 1]) {
      assert.equal(parseFloat(await shown(page, `reading-${engine}-0`)), gain);
      const close = async (name, value) => {
        const number = parseFloat(await shown(page, name));
        assert.ok(Math.abs(number - value) <= 0.006 * value, `${name}: ${number} is not ${value}`);
      };
      await close(`reading-${engine}-1`, 100 * wanted.errors[engine]);
      await close(`reading-${engine}-2`, wanted.efforts[engine]);
      await close(`error-${engine}`, 100 * wanted.errors[engine]); // it flies, too
    }
    assert.notEqual(await shown(page, 'error-0'), before);
    assert.ok(await ringAt(picked));
    // The same gain on E(α).
    const cursor = page.locator('#scene-1 .cursor');
    const { left, right, low, high } = await cursor.evaluate((mark) => ({ ...mark.dataset }));
    const x = Number(left) +
      (Math.log(wanted.gain / low) / Math.log(high / low)) * (Number(right) - Number(left));
    const marked = parseFloat((await cursor.getAttribute('transform')).slice('translate('.length));
    assert.ok(Math.abs(marked - x) < 0.01, `${marked} is not ${x}`);
    // Keys go on from there; a click at nothing changes nothing.
    await page.keyboard.press('ArrowRight');
    const next = parseFloat(await shown(page, 'reading-0-0'));
    assert.ok(next > gain, `${next} is not above ${gain}`);
    assert.ok(!await ringAt(picked));
    const [firstX, firstY] = places[0];
    await page.mouse.click(firstX, firstY + 60);
    assert.equal(parseFloat(await shown(page, 'reading-0-0')), next);
    assert.deepEqual(page.complaints, []);
    await page.close();
  });
}

test('nothing of it breaks a rule of axe-core, light and dark', async () => {
  for (const colorScheme of ['light', 'dark']) {
    const page = await opened({ colorScheme });
    assert.deepEqual(await violations(page), []);
    await page.close();
  }
});

test('it fits a phone, a dark screen and paper', async () => {
  for (const width of [360, 390, 768, 1280, 1920]) {
    for (const colorScheme of ['light', 'dark']) {
      const page = await opened({ viewport: { width, height: 800 }, colorScheme });
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(overflow <= 0, `${overflow} px too wide at ${width} px`);
      const paper = await page.evaluate(
        () => getComputedStyle(document.documentElement).backgroundColor);
      assert.equal(paper, colorScheme === 'dark' ? 'rgb(20, 23, 26)' : 'rgb(255, 255, 255)');
      // No text of a figure leaves it.
      const clipped = await page.evaluate(() =>
        [...document.querySelectorAll('svg.figure text')].filter((text) => {
          const a = text.getBoundingClientRect();
          const b = text.closest('svg.figure').getBoundingClientRect();
          return a.left < b.left - 1 || a.right > b.right + 1 || a.top < b.top - 2 || a.bottom > b.bottom + 2;
        }).map((text) => text.textContent));
      assert.deepEqual(clipped, [], `at ${width} px`);
      if (colorScheme === 'dark') {
        await page.emulateMedia({ media: 'print' });
        assert.equal(await page.evaluate(
          () => getComputedStyle(document.documentElement).backgroundColor), 'rgb(255, 255, 255)');
        assert.ok(!(await part(page, 'play').isVisible()));
      }
      await page.close();
    }
  }
});
