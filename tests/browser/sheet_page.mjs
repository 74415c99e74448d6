// The studio with sheets, in a browser that draws in space: one page for all the tests of a file.

import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';
import { obj_text, square_mesh } from './square_mesh.mjs';
import { open_page, patience, start_studio, webgl_in_software } from './studio_server.mjs';

export const sheets = path.join(process.env.NUNO_SCENES, 'sheets');
export const folder = mkdtempSync(path.join(tmpdir(), 'nuno-sheet-test-'));
export const page_errors = [];
export let page;
let studio;

before(async () => {
  studio = await start_studio(webgl_in_software);
  page = await new_page({ viewport: { width: 1280, height: 800 } });
});

after(async () => {
  await studio?.end();
  rmSync(folder, { recursive: true, force: true });
});

export async function new_page(options) {
  const made = await open_page(studio, options, page_errors);
  await settled(made);
  return made;
}

// Not waitForFunction: it needs eval, which the page's policy forbids.
export async function becomes(where, condition, argument) {
  const until = Date.now() + patience;
  while (!(await where.evaluate(condition, argument))) {
    assert.ok(Date.now() < until, `in vain: ${condition}`);
    await where.waitForTimeout(20);
  }
}
export const settled = (where = page) => becomes(where, () => document.documentElement.dataset.busy === 'false');

export const scene_of = (where = page) => where.evaluate(() => nuno_studio.app.doc.scene);
export const error_of = (where = page) => where.evaluate(() => nuno_studio.app.results.native.flight.error.relative);

export async function open_sheet(name, where = page) {
  await where.click('#gallery');
  await where.click(`.demo:has-text("${name}")`);
  await becomes(where, (wanted) => nuno_studio.app.doc.scene.name === wanted && Boolean(nuno_studio.app.results.native?.flight), name);
  await settled(where);
  await becomes(where, () => Boolean(nuno_studio.space.space));
}

// A small sheet, which bends on its way: for what is tested of the page and not of the engines.
export const patch = {
  initial: square_mesh(6, (u, v) => [u, 1 + v, 0]),
  target: square_mesh(6, (u, v) => [2.5 + Math.sin(2 * u) / 2, 1 + v, 0.5 - Math.cos(2 * u) / 2]),
};
export async function open_patch(where = page) {
  const files = Object.entries(patch).map(([name, mesh]) => {
    const file = path.join(folder, `patch-${name}.obj`);
    writeFileSync(file, obj_text(mesh));
    return file;
  });
  await where.setInputFiles('#file', files);
  await becomes(where, () => nuno_studio.app.doc.scene.name === 'patch-target' && Boolean(nuno_studio.app.results.native?.flight));
  await settled(where);
  await becomes(where, () => Boolean(nuno_studio.space.space));
}

export async function download(act, where = page) {
  const [file] = await Promise.all([where.waitForEvent('download'), act()]);
  const to = path.join(folder, file.suggestedFilename());
  await file.saveAs(to);
  return to;
}
