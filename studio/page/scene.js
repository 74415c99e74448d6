// The scene on the page: the very JSON of a scene file. Undo, autosave, and the scene in the URL.

import { preset, rounded } from './geometry.js';

export function default_scene() {
  return {
    nuno_scene: 1,
    name: 'untitled',
    particles: 32,
    arrival_time: 1,
    gravity: 9.8,
    initial: [[0, 1], [1, 1]],
    target: rounded(preset('s', [2.9, 1.5], 1)),
    cloth: {
      mass: 0.1, air_drag: 0.05, stretch_stiffness: 200, stretch_damping: 0.0006,
      hinge_stiffness: 0.001, hinge_damping: 0,
    },
    launch: 'ballistic',
    reference: 'morph',
    arrival: 'pass',
    damping_ratio: 0.7,
    target_length: 'fit',
    frames_per_second: 60,
  };
}

// As a file, a point to a place in the text.
export const file_text = (scene) =>
  '{\n' + Object.entries(scene).map(([key, value]) => ` ${JSON.stringify(key)}: ${JSON.stringify(value)}`).join(',\n') + '\n}\n';

// A sheet between two meshes, thrown as `nuno throw` does it.
export const sheet_scene = (name, { initial, target }) => ({
  nuno_scene: 1, name, arrival_time: 1, initial, target, launch: 'ballistic', reference: 'morph', damping_ratio: 0.7,
});

const storage_key = 'nuno-studio-scene', land_key = 'nuno-studio-land';
const longest_hash = 60000;
const longest_history = 200;

const to_base64 = (text) =>
  btoa(String.fromCharCode(...new TextEncoder().encode(text)))
    .replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
const from_base64 = (text) =>
  new TextDecoder().decode(
    Uint8Array.from(atob(text.replaceAll('-', '+').replaceAll('_', '/')), (c) => c.charCodeAt(0)));

// What the URL or, where the URL has no scene, the autosave holds: {text: the scene's, null without
// any; lands: whether it is to land exactly, null where nothing says so}.
export function kept() {
  const hash = new URLSearchParams(location.hash.slice(1));
  const lands_of = (value) => (value === null ? null : value === '1');
  try {
    if (hash.has('scene')) return { text: from_base64(hash.get('scene')), lands: lands_of(hash.get('land')) };
  } catch { /* a damaged link: the autosave is next */ }
  try {
    return { text: localStorage.getItem(storage_key), lands: lands_of(localStorage.getItem(land_key)) };
  } catch {
    return { text: null, lands: null };
  }
}

export function keep(text, lands) {
  const land = lands ? '1' : '0';
  try {
    localStorage.setItem(storage_key, text);
    localStorage.setItem(land_key, land);
  } catch { /* storage is off or full; the URL still has the scene */ }
  try {
    const hash = text.length <= longest_hash ? `#scene=${to_base64(text)}&land=${land}` : location.pathname;
    history.replaceState(null, '', hash);
  } catch { /* too many changes a second for the browser; the next one counts */ }
}

// The scene and its past. `scene` may change freely between two commits.
export class Document {
  // `kept(text)` is called with every scene that is to be kept.
  constructor(scene, kept_scene) {
    this.keep = kept_scene;
    this.scene = scene;
    this.past = [];
    this.future = [];
    this.committed = JSON.stringify(scene);
    this.keep(this.committed);
  }

  // What was done since the last commit becomes one step of undo. Says whether anything was.
  commit() {
    const text = JSON.stringify(this.scene);
    if (text === this.committed) return false;
    this.past.push(this.committed);
    if (this.past.length > longest_history) this.past.shift();
    this.future = [];
    this.committed = text;
    this.keep(text);
    return true;
  }

  step(from, onto) {
    if (!from.length) return false;
    onto.push(this.committed);
    this.committed = from.pop();
    this.scene = JSON.parse(this.committed);
    this.keep(this.committed);
    return true;
  }
  undo() { return this.step(this.past, this.future); }
  redo() { return this.step(this.future, this.past); }
  revert() { this.scene = JSON.parse(this.committed); }
}
