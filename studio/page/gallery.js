// The demo scenes, to be opened with one click.

import { preview } from './preview.js';
import { ask } from './client.js';
import { sheet_scene } from './scene.js';

const $ = (id) => document.getElementById(id);

const base64 = (text) => btoa(String.fromCharCode(...new TextEncoder().encode(text)));
const text_of = async (path) => (await fetch(`/scenes/${path}`)).text();

// A demo's scene, whole: the meshes that it names are put in their places.
async function demo_scene(file) {
  const scene = JSON.parse(await text_of(file));
  scene.name ??= file.replace(/\.json$/, '');
  if (typeof scene.initial !== 'string') return scene;
  const upload = async (name) => ({ name, data: base64(await text_of(name)) });
  const meshes = await (await ask('meshes', {}, JSON.stringify({ initial: await upload(scene.initial), target: await upload(scene.target) }))).json();
  return { ...sheet_scene(scene.name, meshes), ...scene, initial: meshes.initial, target: meshes.target };
}

export class Gallery {
  // `open(scene)` shows it.
  constructor({ open, trouble }) {
    this.open = open;
    this.trouble = trouble;
    this.filled = false;
  }

  async show() {
    $('gallery-dialog').showModal();
    if (this.filled) return;
    this.filled = true;
    try {
      const files = (await (await fetch('/api/about')).json()).demos;
      const scenes = await Promise.all(files.map(demo_scene));
      $('gallery-scenes').replaceChildren(...scenes.map((scene) => this.card(scene)));
    } catch (error) {
      this.filled = false;
      $('gallery-dialog').close();
      this.trouble(error.message);
    }
  }

  card(scene) {
    const button = document.createElement('button');
    button.className = 'demo';
    const name = document.createElement('span');
    name.textContent = scene.name;
    const what = document.createElement('small');
    what.textContent = scene.initial.vertices ? `sheet, ${scene.initial.vertices.length} points` : `line, ${scene.particles ?? 32} points`;
    button.append(preview(scene), name, what);
    button.addEventListener('click', () => {
      $('gallery-dialog').close();
      this.open(scene);
    });
    return button;
  }
}
