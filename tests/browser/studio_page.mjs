// The studio in a real browser with real pointer input: one page for all the tests of a file.

import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';
import { open_page, patience, program, start_studio } from './studio_server.mjs';

export { patience, program };
export const folder = mkdtempSync(path.join(tmpdir(), 'nuno-studio-test-'));
export let page;
let studio;
export const page_errors = [];

before(async () => {
  studio = await start_studio();
  page = await new_page({ viewport: { width: 1280, height: 800 } });
});

after(async () => {
  await studio?.end();
  rmSync(folder, { recursive: true, force: true });
});

export async function new_page(options) {
  const made = await open_page(studio, options, page_errors);
  await settled(made);
  // The paper's control, and not landed exactly: a link that does not ask for it.
  const paper = await made.evaluate(() => ({ ...nuno_studio.app.doc.scene, reference: 'hold', damping_ratio: 0 }));
  await made.goto('about:blank');
  await made.goto(`${studio.url}#scene=${Buffer.from(JSON.stringify(paper)).toString('base64url')}`);
  await settled(made);
  return made;
}

// The page says at once that it waits for an answer, and only when all is drawn that it does not.
export async function settled(where = page) {
  await becomes(where, () => document.documentElement.dataset.busy === 'false');
}

// Not waitForFunction: it needs eval, which the page's policy forbids.
export async function becomes(where, condition) {
  const until = Date.now() + patience;
  while (!(await where.evaluate(condition))) {
    assert.ok(Date.now() < until, `in vain: ${condition}`);
    await where.waitForTimeout(20);
  }
}

export const scene_of = (where = page) => where.evaluate(() => nuno_studio.app.doc.scene);
export const flight_of = (engine, where = page) => where.evaluate((name) => {
  const { alpha, error, backend, control_effort } = nuno_studio.app.results[name].flight;
  return { alpha, error, backend, control_effort };
}, engine);

// Along points of the stage, given in shares of its width and height.
export async function stroke(points) {
  const box = await page.locator('#stage').boundingBox();
  const at = ([x, y]) => [box.x + x * box.width, box.y + y * box.height];
  await page.mouse.move(...at(points[0]));
  await page.mouse.down();
  for (const point of points.slice(1)) await page.mouse.move(...at(point));
  await page.mouse.up();
  await settled();
}
export const curve = (count, f) => Array.from({ length: count }, (_, i) => f(i / (count - 1)));

export async function download(act) {
  const [file] = await Promise.all([page.waitForEvent('download'), act()]);
  const to = path.join(folder, file.suggestedFilename());
  await file.saveAs(to);
  return to;
}
