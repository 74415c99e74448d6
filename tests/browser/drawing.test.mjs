// Drawings as nuno reads them, against the browser's own getPointAtLength.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const folder = `${process.env.NUNO_TEST_DATA}/svg`;
const files = readdirSync(folder).filter((name) => name.endsWith('.svg'));

let browser;
before(async () => {
  browser = await chromium.launch({
    executablePath: '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu'],
  });
});
after(() => browser?.close());

/// The element with an id of the drawing's curve and, on the page in px, points along it. So many
/// points that corners between them matter to 1e-5 of the length.
function drawnByBrowser() {
  const element = document.querySelector('#curve, #box, #egg');
  let matrix = element.getScreenCTM(), geometry = element;
  if (element.localName === 'use') { // its own x and y are no part of its matrix
    geometry = document.querySelector(element.href.baseVal);
    matrix = matrix.translate(element.x.baseVal.value, element.y.baseVal.value)
      .multiply(geometry.transform.baseVal.consolidate().matrix);
  }
  const count = 24000, length = geometry.getTotalLength();
  const points = [];
  for (let i = 0; i <= count; ++i) {
    const { x, y } = geometry.getPointAtLength(length * i / count).matrixTransform(matrix);
    points.push([x, y]);
  }
  return { id: element.id, points, height: document.documentElement.height.baseVal.value };
}

/// Points at equal arc lengths.
function resampled(points, count) {
  const along = [0];
  for (let i = 1; i < points.length; ++i) {
    const [x, y] = points[i], [u, v] = points[i - 1];
    along.push(along[i - 1] + Math.hypot(x - u, y - v));
  }
  const length = along.at(-1), result = [];
  for (let k = 0, i = 0; k < count; ++k) {
    const wanted = length * k / (count - 1);
    while (i + 2 < along.length && along[i + 1] < wanted) ++i;
    const share = Math.min(1, (wanted - along[i]) / (along[i + 1] - along[i]));
    result.push(points[i].map((a, axis) => a + share * (points[i + 1][axis] - a)));
  }
  return { length, points: result };
}

test('there are 25 drawings', () => assert.ok(files.length >= 25, `${files.length}`));

for (const name of files) {
  test(name, async () => {
    const file = join(folder, name);
    const page = await browser.newPage({ viewport: { width: 1000, height: 800 } });
    await page.goto(pathToFileURL(file).href);
    const { id, points, height } = await page.evaluate(drawnByBrowser);
    await page.close();
    const metres = 0.0254 / 96; // of a px
    const drawn = resampled(points.map(([x, y]) => [x * metres, (height - y) * metres]), 32);

    const curve = `${file}#${id}`;
    const flight = JSON.parse(
      execFileSync(process.env.NUNO_PROGRAM, ['throw', curve, curve, '--time', '1', '--out', '-'],
        { stdio: ['ignore', 'pipe', 'ignore'] }));
    const read = flight.frames.positions[0];
    assert.equal(read.length, 32);
    const worst = Math.max(
      ...read.map(([x, y], i) => Math.hypot(x - drawn.points[i][0], y - drawn.points[i][1])));
    console.log(`${(worst / drawn.length).toExponential(1)} of the length`);
    assert.ok(worst <= 1e-4 * drawn.length, `${worst / drawn.length} of the length`);
  });
}
