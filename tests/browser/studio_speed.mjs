// How quick the studio is with a sheet of 256 particles, drawn without a graphics card: from a move of
// the target to the new flight drawn, and pictures a second while it plays and while it is turned.
//   NUNO_PROGRAM=build/nuno node tests/browser/studio_speed.mjs
// Other work on the machine is in the times; the seconds of CPU beside them are its own alone.

import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { obj_text, square_mesh } from './square_mesh.mjs';
import { patience, start_studio, webgl_in_software } from './studio_server.mjs';

const side = 16, moves = 40;
const start = obj_text(square_mesh(side, (u, v) => [u, 1 + v, 0]));
const half_pipe = obj_text(square_mesh(side, (u, v) => [3 + Math.sin(Math.PI * (u - 0.5)) / Math.PI, 1.5 - Math.cos(Math.PI * (u - 0.5)) / Math.PI, v]));

// Of the studio and its browser: all that this process began [s].
function cpu_seconds() {
  const parents = new Map(), ticks = new Map();
  for (const pid of readdirSync('/proc').filter((name) => /^\d+$/.test(name)).map(Number)) {
    try {
      const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ').at(-1).split(' ');
      parents.set(pid, Number(fields[1]));
      ticks.set(pid, Number(fields[11]) + Number(fields[12]));
    } catch { /* it has just ended */ }
  }
  const is_ours = (pid) => pid === process.pid || (parents.has(pid) && is_ours(parents.get(pid)));
  return [...ticks].filter(([pid]) => pid !== process.pid && is_ours(pid)).reduce((sum, [, t]) => sum + t, 0) / 100;
}

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

const studio = await start_studio(webgl_in_software);
const page = await (await studio.browser.newContext({ viewport: { width: 1440, height: 900 } })).newPage();
page.setDefaultTimeout(patience);
const settled = async () => {
  while (await page.evaluate(() => document.documentElement.dataset.busy !== 'false')) await page.waitForTimeout(20);
};
const folder = mkdtempSync(path.join(tmpdir(), 'nuno-speed-'));

try {
  await page.goto(studio.url);
  await settled();
  await page.click('#first-done');
  const files = ['start.obj', 'target.obj'].map((name) => path.join(folder, name));
  writeFileSync(files[0], start);
  writeFileSync(files[1], half_pipe);
  await page.setInputFiles('#file', files);
  while (await page.evaluate(() => !nuno_studio.space.space || nuno_studio.app.results.native?.flight?.kind !== 'sheet')) await page.waitForTimeout(50);
  await settled();
  console.log(`load ${readFileSync('/proc/loadavg', 'utf8').trim()}`);
  await drag();
  await pictures('plays', async () => page.click('#play'), async () => page.click('#play'));
  await page.click('#play');
  await page.click('#play');
  await pictures('is turned', turn_begins, () => page.mouse.up(), turn);
} finally {
  await studio.end();
  rmSync(folder, { recursive: true, force: true });
}

async function drag() {
  const [x, y] = await page.evaluate(() => {
    const { handle, camera } = nuno_studio.space.space;
    const place = handle.position.clone().project(camera);
    const box = document.getElementById('space').getBoundingClientRect();
    return [box.x + ((place.x + 1) / 2) * box.width, box.y + ((1 - place.y) / 2) * box.height];
  });
  await page.mouse.move(x - 1, y);
  await page.mouse.move(x, y);
  await page.mouse.down();
  const before = cpu_seconds();
  const taken = [];
  for (let i = 1; i <= moves; i++) {
    const drawn = page.evaluate(() => new Promise((resolve) => {
      const { latency } = nuno_studio;
      const record = latency.record;
      latency.record = (until) => {
        const known = latency.all.length;
        record.call(latency, until);
        if (latency.all.length === known) return;
        delete latency.record;
        resolve(latency.all.at(-1));
      };
    }));
    await page.mouse.move(x - 2 * i, y - 2 * i);
    taken.push(await drawn);
  }
  const cpu = (cpu_seconds() - before) / moves;
  await page.mouse.up();
  await settled();
  console.log(`a move of the target: drawn after ${median(taken).toFixed(0)} ms (median of ${taken.length}); ${(1000 * cpu).toFixed(0)} ms of CPU`);
}

async function turn_begins() {
  const box = await page.locator('#space').boundingBox();
  await page.mouse.move(box.x + 0.2 * box.width, box.y + 0.85 * box.height);
  await page.mouse.down();
}
async function turn(until) {
  const box = await page.locator('#space').boundingBox();
  for (let i = 0; performance.now() < until; i++) {
    await page.mouse.move(box.x + (0.2 + 0.1 * Math.sin(i / 10)) * box.width, box.y + 0.85 * box.height);
    await page.waitForTimeout(8);
  }
}

async function pictures(what, begin, end, meanwhile = (until) => page.waitForTimeout(until - performance.now())) {
  await page.evaluate(() => {
    const { space } = nuno_studio.space;
    if (!space.counted) {
      const draw = space.draw.bind(space);
      space.draw = (...all) => { draw(...all); space.counted++; };
    }
    space.counted = 0;
  });
  await begin();
  const drawn = () => page.evaluate(() => nuno_studio.space.space.counted);
  const [first, cpu, from] = [await drawn(), cpu_seconds(), performance.now()];
  await meanwhile(from + 4000);
  const [count, used, seconds] = [(await drawn()) - first, cpu_seconds() - cpu, (performance.now() - from) / 1000];
  await end();
  console.log(`while it ${what}: ${(count / seconds).toFixed(0)} pictures a second; ${((1000 * used) / count).toFixed(0)} ms of CPU each`);
}
