// Animated meshes before Khronos' validator: it has nothing to say.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import validator from 'gltf-validator';

const sheets = join(process.env.NUNO_SCENES, 'sheets');
const strip = join(process.env.NUNO_TEST_DATA, 'sheets', 'textured-strip');

let folder;
before(() => { folder = mkdtempSync(join(tmpdir(), 'nuno-gltf-')); });
after(() => rmSync(folder, { recursive: true, force: true }));

// Writes an animated mesh by these arguments of the program and hands it to the validator.
async function validated(...words) {
  const file = join(folder, 'flight.glb');
  execFileSync(process.env.NUNO_PROGRAM, [...words, '--out', file]);
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)));
  const { issues, info } = report;
  // Severity 2 is a hint: a texture's points without a texture, which is the animator's to add.
  assert.deepEqual(issues.messages.filter(({ severity }) => severity < 2), []);
  assert.equal(issues.numErrors + issues.numWarnings, 0);
  assert.equal(info.animationCount, 1);
  assert.equal(info.drawCallCount, 1);
  assert.ok(info.hasMorphTargets);
  return report;
}

const scenes = readdirSync(sheets).filter((name) => name.endsWith('.json'));
test('there are demo sheets', () => assert.ok(scenes.length >= 5));
for (const scene of scenes) {
  test(scene, () => validated('simulate', join(sheets, scene), '--alpha', '0.01'));
}

test('a mesh with a texture, thrown', async () => {
  const report = await validated(
    'throw', `${strip}-start.obj`, `${strip}-target.obj`, '--time', '0.73', '--settle');
  assert.equal(report.info.totalVertexCount, 12 + 3, 'three vertices on the seam stand twice');
});

test('the validator would speak up', async () => {
  const bytes = new Uint8Array(readFileSync(join(folder, 'flight.glb')));
  bytes[bytes.length - 2] = 0xff;
  bytes[bytes.length - 1] = 0x7f; // NaN
  const { issues } = await validator.validateBytes(bytes);
  assert.ok(issues.numErrors > 0);
});
