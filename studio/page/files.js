// Scenes from files and links; results, reports and films into files.

import { ask, film_progress } from './client.js';
import { file_text } from './scene.js';
import { app, no_refining, scene } from './state.js';

const $ = (id) => document.getElementById(id);

const look_again = 250; // ms, at how much of a film is made

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
    $('stage').addEventListener('dragover', (event) => event.preventDefault());
    $('stage').addEventListener('drop', (event) => {
      event.preventDefault();
      this.open_files(event.dataTransfer.files);
    });
    for (const [kind, ending] of [['result', '-result.json'], ['report', '-report.html'], ['film', '.mp4']]) {
      $(`save-${kind}`).addEventListener('click', () => throws.during(this.make(kind, ending)));
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

  open_files([file]) {
    if (file) this.throws.during(file.text().then((text) => this.open_text(text, file.name)));
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
  async make(kind, ending) {
    const engine = app.engine === 'box2d' ? 'box2d' : 'native';
    const alpha = app.alpha ?? (engine === 'box2d' && !app.own_gain ? app.results.native?.best : null) ?? null;
    const refine = alpha === null && app.refines && !no_refining();
    const parameters = kind === 'report' ? {} : { backend: engine, ...(alpha === null ? {} : { alpha }), ...(refine ? { refine: 1 } : {}) };
    const { page } = this.throws.channels.file;
    const buttons = ['result', 'report', 'film'].map((each) => $(`save-${each}`));
    const bar = $('making').querySelector('progress');
    $('export').open = false;
    $('making').hidden = false;
    $('making').querySelector('span').textContent = { result: 'Result', report: 'Report', film: 'Film' }[kind];
    bar.removeAttribute('value');
    for (const button of buttons) button.disabled = true;
    $('status').textContent = `The ${kind} is being made`;
    const watch = kind === 'film' && setInterval(async () => {
      const share = await film_progress(page).catch(() => 0);
      if (share > 0) bar.value = share;
    }, look_again);
    try {
      const response = await ask(kind, { page, ...parameters }, JSON.stringify(scene()));
      download(await response.blob(), `${file_name()}${ending}`);
      $('status').textContent = `The ${kind} is saved`;
    } catch (error) {
      this.trouble(error.message);
    }
    clearInterval(watch);
    for (const button of buttons) button.disabled = false;
    $('making').hidden = true;
  }
}
