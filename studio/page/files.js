// Scenes from files and links; results, reports and films into files.

import { ask, share_made } from './client.js';
import { default_scene, file_text, sheet_scene } from './scene.js';
import { app, is_sheet, no_refining, other_engine, scene } from './state.js';

const $ = (id) => document.getElementById(id);

// What the program makes, and how its file ends.
const kinds = {
  result: { path: 'result', ending: '-result.json', word: 'Result' },
  report: { path: 'report', ending: '-report.html', word: 'Report', takes_long: true },
  glb: { path: 'animation', parameters: { format: 'glb' }, ending: '.glb', word: 'Animated mesh' },
  pc2: { path: 'animation', parameters: { format: 'pc2' }, ending: '.pc2', word: 'Point cache' },
  film: { path: 'film', ending: '.mp4', word: 'Film', takes_long: true },
};
const is_mesh = ({ name }) => /\.(obj|ply|gltf|glb)$/i.test(name);
const is_drawing = ({ name }) => /\.(svg|csv)$/i.test(name);
const is_end = ({ name }) => /target|end|after|pose/i.test(name);

const look_again = 250; // ms, at how much is made

const file_name = () => (scene().name || 'scene').replace(/[^\p{L}\p{N} ._-]/gu, '-');

function download(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export function save() {
  download(new Blob([file_text(scene())], { type: 'application/json' }), `${file_name()}.json`);
}

const remark_stays = 8000; // ms

const upload = async (file) => {
  const bytes = new Uint8Array(await file.arrayBuffer());
  let text = '';
  for (let at = 0; at < bytes.length; at += 32768) text += String.fromCharCode(...bytes.subarray(at, at + 32768));
  return { name: file.name, data: btoa(text) };
};

// The scene of a text with every default written out. Throws what the program refuses it with.
export const validated = async (text) => (await ask('scene', {}, text)).json();

export class Files {
  // use(scene): shows it; trouble(message).
  constructor(throws, { use, trouble }) {
    Object.assign(this, { throws, use, trouble });
    $('save').addEventListener('click', save);
    $('open').addEventListener('click', () => $('file').click());
    $('file').addEventListener('change', (event) => {
      this.open_files(event.target.files);
      event.target.value = '';
    });
    this.listen_to_drops();
    for (const kind of Object.keys(kinds)) {
      $(`save-${kind}`).addEventListener('click', () => throws.during(this.make(kind)));
    }
    document.addEventListener('click', (event) => {
      if (!$('export').contains(event.target)) $('export').open = false;
    });
    $('export').addEventListener('keydown', (event) => {
      if (event.key !== 'Escape' || !$('export').open) return;
      event.stopPropagation();
      $('export').open = false;
      $('export').querySelector('summary').focus();
    });
  }

  // Anywhere on the page.
  listen_to_drops() {
    const over = (on) => document.documentElement.classList.toggle('dropping', on);
    document.addEventListener('dragover', (event) => {
      event.preventDefault();
      over(true);
    });
    document.addEventListener('dragleave', (event) => event.relatedTarget || over(false));
    document.addEventListener('drop', (event) => {
      event.preventDefault();
      over(false);
      this.open_files(event.dataTransfer.files);
    });
  }

  // A scene; or meshes, the start's and the target's; or drawings of lines.
  open_files(list) {
    const files = [...list];
    if (!files.length) return;
    if (files.every(is_mesh)) this.throws.during(this.open_meshes(files));
    else if (files.every(is_drawing)) this.throws.during(this.open_drawings(files));
    else this.throws.during(files[0].text().then((text) => this.open_text(text, files[0].name)));
  }

  // The start and the target of them, by their names where these tell; one alone waits for its other
  // pose, unless it has a morph target.
  async open_meshes(files) {
    const uploads = await Promise.all(files.map(upload));
    if (uploads.length === 1 && this.waiting) uploads.unshift(this.waiting);
    if (uploads.length > 1 && is_end(uploads[0]) && !is_end(uploads[1])) uploads.reverse();
    const [initial, target] = uploads;
    this.waiting = null;
    try {
      const meshes = await (await ask('meshes', {}, JSON.stringify({ initial, target }))).json();
      const name = (target ?? initial).name.replace(/\.\w+$/, '');
      this.use(await validated(JSON.stringify(sheet_scene(name, meshes))));
      if (meshes.remarks.length) this.trouble(`${meshes.remarks.join('. ')}.`, remark_stays);
    } catch (error) {
      if (!target && /is one mesh/.test(error.message)) this.waiting = initial;
      this.trouble(this.waiting ? `${initial.name} is the start. Now drop or open its other pose: the same mesh, where it shall arrive.` : error.message, remark_stays);
    }
  }

  async open_drawings(files) {
    try {
      const [initial, target] = await Promise.all(files.map(upload));
      const drawn = await (await ask('drawings', {}, JSON.stringify({ initial, target }))).json();
      const lines = is_sheet() ? { ...default_scene(), ...drawn } : { ...scene(), ...drawn };
      this.use(await validated(JSON.stringify({ ...lines, name: files.at(-1).name.replace(/\.\w+$/, '') })));
    } catch (error) {
      this.trouble(error.message, remark_stays);
    }
  }

  async open_text(text, name) {
    try {
      const opened = await this.throws.during(validated(text));
      if (!JSON.parse(text).name && name) opened.name = name.replace(/\.json$/i, '');
      this.use(opened);
    } catch (error) {
      this.trouble(`${name ? `${name}: ` : ''}${error.message.replace(/^scene\.json: /, '')}`);
    }
  }

  // What the program makes of the throw that is shown.
  async make(kind) {
    const { path, ending, word, takes_long } = kinds[kind];
    const engine = app.engine === 'box2d' ? other_engine() : 'native';
    const alpha = app.alpha ?? (engine !== 'native' && !app.own_gain ? app.results.native?.best : null) ?? null;
    const refine = alpha === null && app.refines && !no_refining();
    const parameters = kind === 'report' ? {} : { ...kinds[kind].parameters, backend: engine, ...(alpha === null ? {} : { alpha }), ...(refine ? { refine: 1 } : {}) };
    const { page } = this.throws.channels.file;
    const buttons = Object.keys(kinds).map((each) => $(`save-${each}`));
    const bar = $('making').querySelector('progress');
    const stop = new AbortController();
    $('export').open = false;
    $('making').hidden = false;
    $('making-what').textContent = word;
    $('making-end').onclick = () => stop.abort();
    bar.removeAttribute('value');
    for (const button of buttons) button.disabled = true;
    $('status').textContent = `The ${word.toLowerCase()} is being made`;
    const watch = takes_long && setInterval(async () => {
      const share = await share_made(page).catch(() => 0);
      if (share > bar.value) bar.value = share;
    }, look_again);
    try {
      const response = await ask(path, { page, ...parameters }, JSON.stringify(scene()), stop.signal);
      download(await response.blob(), `${file_name()}${ending}`);
      $('status').textContent = `The ${word.toLowerCase()} is saved`;
    } catch (error) {
      if (stop.signal.aborted) $('status').textContent = `The ${word.toLowerCase()} is given up`;
      else this.trouble(error.message.replace(/^--out: flight\.\w+: /, ''));
    }
    clearInterval(watch);
    for (const button of buttons) button.disabled = false;
    $('making').hidden = true;
  }
}
