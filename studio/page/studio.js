// The page: its parts put together, and what its buttons and keys do.

import { Charts } from './charts.js';
import { Editor } from './editor.js';
import { make_fields, update_fields } from './fields.js';
import { Files, save, validated } from './files.js';
import { Gallery } from './gallery.js';
import * as geometry from './geometry.js';
import { show_hint, welcome_newcomers } from './hint.js';
import { listen } from './keyboard.js';
import { digits } from './numbers.js';
import { Player } from './player.js';
import { default_scene, Document, keep, kept } from './scene.js';
import { announce, show_scores } from './scores.js';
import { swap_poses } from './sheet.js';
import { SpaceStage } from './space_stage.js';
import { draw_stage, fit_view } from './stage.js';
import { app, end_time, engine_names, is_sheet, no_refining, now, other_engine, scene } from './state.js';
import { Throws } from './throws.js';
import { View } from './view.js';

const $ = (id) => document.getElementById(id);

const key_step = 1 / 60; // seconds of the flight
const trouble_of_a_scene = 8000; // ms that it stays
const usual_damping = 0.7;
const shapes = ['initial', 'target'];
const tools = ['move', 'turn', 'scale', 'draw', 'points', 'pan'];
const sheet_tools = ['move', 'turn', 'scale', 'pan'], chain_tools = ['move', 'draw', 'points', 'pan'];
const engine_views = ['native', 'box2d', 'over', 'side'];
const toggles = ['loop', 'after', 'ghosts', 'forces', 'wires', 'errors'];

// ---------------------------------------------------------------------------------- drawing

const view = new View($('stage'));
const colors = {};
let fit_due = false; // once the first flight of a scene is there, its whole way comes into view

function read_colors() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ['paper', 'panel', 'line', 'ink', 'quiet', 'faint', 'grid', 'axis', 'initial', 'target', 'a', 'b', 'force', 'bad']) {
    colors[name] = style.getPropertyValue(`--${name}`).trim();
  }
  for (const name of ['shade', 'sky']) colors[name] = Number(style.getPropertyValue(`--${name}`));
}

// In the next frame, however often something changes until then: the stage, and with `all` the rest.
let frame = 0, all_due = false;
function draw_soon(all = false) {
  all_due ||= all;
  frame ||= requestAnimationFrame(draw);
}

function draw() {
  cancelAnimationFrame(frame);
  frame = 0;
  if (is_sheet()) space.draw(colors);
  else draw_stage(view, colors, editor.gesture?.kind === 'draw' ? editor.gesture.points : null);
  show_hint(space.trouble, editor.gesture?.kind === 'draw' ? editor.gesture.points : null);
  player.show_clock();
  if (!all_due) return;
  all_due = false;
  charts.draw(colors);
  show_scores(throws);
  throws.latency.drawn();
}

let note_until = 0; // a note about the scene itself stays for a while
function trouble(message, stay = 0) {
  if (!message && performance.now() < note_until) return;
  note_until = performance.now() + stay;
  $('trouble').hidden = !message;
  if (message) $('trouble').textContent = message.replace(/^scene\.json: /, '');
}

// ---------------------------------------------------------------------------------- parts

const throws = new Throws({
  shown: () => {
    if (fit_due && app.results.native?.flight) {
      fit_due = false;
      fit();
    }
    draw_soon(true);
  },
  // For tests and for the pointer: whether an answer is still on its way. All that came is drawn then.
  busy: (busy) => {
    if (!busy) {
      announce();
      all_due = true;
      draw();
    }
    document.documentElement.dataset.busy = busy;
  },
  trouble,
});
const player = new Player(draw);
const space = new SpaceStage({
  changed: (live, time) => {
    player.pause();
    if (live) app.time = null;
    changed(live, time);
  },
  redraw: () => app.doc && draw_soon(),
});
const gallery = new Gallery({ open: (demo) => throws.during(validated(JSON.stringify(demo)).then(use, (error) => trouble(error.message))), trouble });
const files = new Files(throws, { use, trouble });
const charts = new Charts(try_gain);
const editor = new Editor($('stage'), view, {
  get doc() { return app.doc; },
  get selected() { return app.selected; },
  get tool() { return app.tool; },
  get vertex() { return app.vertex; },
  set vertex(index) { app.vertex = index; },
  changed: (live, time) => {
    // What follows the hand is how the cloth arrives.
    player.pause();
    if (live) app.time = null;
    changed(live, time);
  },
  drawn: () => {
    player.pause();
    app.time = null;
    set_tool('move');
    changed(false);
  },
  select,
  redraw: () => draw_soon(),
});

// The scene has changed; live: it is still changing. `time` is that of the event behind it.
function changed(live, time = performance.now()) {
  if (live) {
    throws.latency.move(time);
  } else {
    throws.latency.forget();
    app.doc.commit();
    show_scene();
  }
  throws.request(live);
  draw_soon();
}

// What the page says of the scene in words.
function show_scene() {
  update_fields();
  const { name, cloth, initial, reference, damping_ratio, launch } = scene();
  $('cloth-note').textContent = is_sheet()
    ? `${digits(cloth.areal_density)} kg/m², ${initial.vertices.length} points`
    : `${digits(cloth.mass)} kg, ${digits(geometry.length(initial))} m`;
  $('control-note').textContent = [reference, damping_ratio ? `ζ ${digits(damping_ratio)}` : '', launch].filter(Boolean).join(', ');
  if (document.activeElement !== $('name')) $('name').value = name ?? '';
  document.title = `${name || 'untitled'} – nuno studio`;
  $('undo').disabled = !app.doc.past.length;
  $('redo').disabled = !app.doc.future.length;
  $('snap').title = app.selected === 'target' ? "Give the target the cloth's length (L)" : "Give the cloth the target's length (L)";
}

// ---------------------------------------------------------------------------------- actions

// One of a group of radio buttons.
function choose(group, names, chosen) {
  for (const name of names) {
    $(`${group}-${name}`).setAttribute('aria-checked', name === chosen);
    $(`${group}-${name}`).tabIndex = name === chosen ? 0 : -1;
  }
}

const fit = () => (is_sheet() ? space.fit() : fit_view(view));

// What cloth it is, whatever its shapes: a sheet's faces.
const mesh_of_scene = () => JSON.stringify(scene().initial.faces ?? null);
let shown_mesh = '';

// A sheet's stage and tools in place of a chain's.
async function show_form() {
  shown_mesh = mesh_of_scene();
  const form = is_sheet() ? 'sheet' : 'chain';
  document.querySelector('main').dataset.form = form;
  $('stage').hidden = form === 'sheet';
  $('space').hidden = form === 'chain';
  for (const each of document.querySelectorAll('[data-for]')) each.hidden = each.dataset.for !== form;
  const other = engine_names[other_engine()];
  $('engine-box2d-name').textContent = other;
  $('own-name').textContent = `${other} searches its own best α`;
  if (form === 'chain') return;
  if (app.engine === 'side') app.engine = 'over';
  await space.open();
  space.set_tool(app.tool);
  fit();
  draw_soon(true);
}

function select(name) {
  app.selected = name;
  app.vertex = null;
  choose('select', shapes, name);
  show_scene();
  draw_soon();
}

function set_tool(name) {
  if (!(is_sheet() ? sheet_tools : chain_tools).includes(name)) return;
  app.tool = name;
  space.set_tool(name);
  for (const each of tools) $(`tool-${each}`).setAttribute('aria-pressed', each === name);
  if (name !== 'pan') player.pause();
  draw_soon();
}

function set_engine(name) {
  app.engine = name;
  choose('engine', engine_views, name);
  $('own-row').hidden = name === 'native';
  document.querySelector('main').classList.toggle('beside', name === 'side');
  view.resize(name === 'side' ? 2 : 1);
  fit();
  throws.request(false);
  draw_soon(true);
}

function reshape(line) {
  scene()[app.selected] = geometry.rounded(line);
  app.vertex = null;
  changed(false);
}

function step_history(done) {
  if (!done) return;
  app.vertex = null;
  if (shown_mesh !== mesh_of_scene()) {
    // Another cloth: what is shown is not of it.
    throws.drop();
    Object.assign(app, { alpha: null, results: {}, time: null });
    fit_due = true;
    show_form();
    set_tool('move');
  }
  throws.latency.forget();
  show_scene();
  throws.request(false);
  draw_soon();
}

function toggle(name) {
  app[name] = !app[name];
  $(name).setAttribute('aria-pressed', app[name]);
  if (name === 'after' && now() > end_time()) app.time = null;
  draw_soon();
}

function try_gain(alpha, live) {
  if (app.alpha === null && alpha === null) return;
  app.alpha = alpha;
  app.refines = false; // at a gain of its own
  throws.request(live);
  draw_soon(true);
}

function refine_on(on) {
  app.refines = on;
  app.alpha = null;
  keep(app.doc.committed, on);
  throws.request(false);
  draw_soon(true);
}

// The control with which a cloth can be corrected off.
function set_up_refining() {
  const { reference, damping_ratio } = scene();
  scene().reference = 'morph';
  if (reference !== 'morph' || !(damping_ratio > 0)) scene().damping_ratio = usual_damping;
  app.refines = no_refining() === '';
  changed(false);
  $('refine').disabled = false;
  $('refine').focus();
}

function use(new_scene, text_of_problem) {
  throws.drop();
  if (app.doc) {
    app.doc.scene = new_scene;
    app.doc.commit();
  } else {
    app.doc = new Document(new_scene, (text) => keep(text, app.refines));
  }
  Object.assign(app, { alpha: null, results: {}, time: null, vertex: null });
  player.pause();
  fit_due = true;
  show_form();
  select('target');
  set_tool('move');
  set_engine(app.engine);
  if (text_of_problem) trouble(text_of_problem, trouble_of_a_scene);
}

const selected_line = () => scene()[app.selected];
const actions = {
  reverse: () => reshape(geometry.reversed(selected_line())),
  'flip-x': () => reshape(geometry.flipped(selected_line(), 'x')),
  'flip-y': () => reshape(geometry.flipped(selected_line(), 'y')),
  snap: () => {
    const other = scene()[app.selected === 'target' ? 'initial' : 'target'];
    reshape(geometry.scaled(selected_line(), geometry.length(other) / geometry.length(selected_line())));
  },
  undo: () => step_history(app.doc.undo()),
  redo: () => step_history(app.doc.redo()),
  'fit-view': () => { fit(); draw_soon(); },
  swap: () => { swap_poses(); changed(false); },
  gallery: () => gallery.show(),
  'refine-set': set_up_refining,
  play: () => player.play(!app.playing),
  new: () => { app.refines = true; use(default_scene()); },
  help: () => $('help-dialog').showModal(),
  theme: () => {
    const next = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    try { localStorage.setItem('nuno-studio-theme', next); } catch { /* for this visit only */ }
    set_theme(next);
  },
};

// ---------------------------------------------------------------------------------- wiring

for (const [id, act] of Object.entries(actions)) $(id).addEventListener('click', () => act());
for (const name of toggles) $(name).addEventListener('click', () => toggle(name));
for (const name of shapes) $(`select-${name}`).addEventListener('click', () => select(name));
for (const name of tools) $(`tool-${name}`).addEventListener('click', () => set_tool(name));
for (const name of engine_views) $(`engine-${name}`).addEventListener('click', () => set_engine(name));
for (const button of document.querySelectorAll('.best')) button.addEventListener('click', () => try_gain(null, false));
$('refine').addEventListener('change', (event) => refine_on(event.target.checked));
$('own').addEventListener('change', (event) => {
  app.own_gain = event.target.checked;
  throws.request(false);
  draw_soon(true);
});
$('preset').append(new Option('Shape', ''), ...Object.entries(geometry.presets).map(([name, { label }]) => new Option(label, name)));
$('preset').addEventListener('change', (event) => {
  const wanted = geometry.length(scene().initial);
  reshape(geometry.preset(event.target.value, geometry.centroid(selected_line()), wanted));
  event.target.value = '';
});
$('material').addEventListener('change', async (event) => {
  const { cloth, ...rest } = scene();
  app.doc.scene = await throws.during(validated(JSON.stringify({ ...rest, material: event.target.value })));
  event.target.value = '';
  changed(false);
});
$('name').addEventListener('input', (event) => (scene().name = event.target.value));
$('name').addEventListener('change', () => { app.doc.commit(); show_scene(); });
$('name').addEventListener('keydown', (event) => (event.key === 'Enter' || event.key === 'Escape') && event.target.blur());

listen({
  editor, stage: $('stage'), shape_key: (event) => (is_sheet() ? space.key(event) : editor.key(event)),
  commands: { z: actions.undo, 'shift z': actions.redo, y: actions.redo, s: save, o: () => $('file').click() },
  actions: {
    1: () => select('initial'), 2: () => select('target'),
    v: () => set_tool('move'), t: () => set_tool('turn'), s: () => set_tool('scale'), d: () => set_tool('draw'), p: () => set_tool('points'), h: () => set_tool('pan'),
    r: actions.reverse, f: actions['flip-x'], F: actions['flip-y'], l: actions.snap,
    0: actions['fit-view'], o: () => toggle('loop'), a: () => toggle('after'), g: () => toggle('ghosts'), c: () => toggle('forces'), w: () => toggle('wires'), x: () => toggle('errors'),
    e: () => set_engine(engine_views[(engine_views.indexOf(app.engine) + 1) % engine_views.length]),
    ',': () => player.go_to(now() - key_step), '.': () => player.go_to(now() + key_step),
    '?': actions.help,
  },
  on_space: actions.play,
  on_escape: () => set_tool('move'),
});

const dark = matchMedia('(prefers-color-scheme: dark)');
function set_theme(name) {
  document.documentElement.dataset.theme = name;
  read_colors();
  if (app.doc) draw_soon(true);
}
function kept_theme() {
  try { return localStorage.getItem('nuno-studio-theme'); } catch { return null; }
}
dark.addEventListener('change', () => kept_theme() || set_theme(dark.matches ? 'dark' : 'light'));

new ResizeObserver(() => {
  if (!app.doc || !is_sheet() || !space.space) return;
  space.space.resize();
  draw();
}).observe($('space'));
new ResizeObserver(() => {
  const was = view.width;
  if ($('stage').hidden) return;
  view.resize();
  if (!app.doc) return;
  if (was < 10) fit_view(view);
  draw();
}).observe($('stage'));
for (const id of ['gain-chart', 'pareto-chart']) new ResizeObserver(() => app.doc && draw_soon(true)).observe($(id));
addEventListener('hashchange', () => {
  const { text, lands } = kept();
  if (lands !== null) app.refines = lands;
  if (text && text !== app.doc.committed) files.open_text(text);
});

async function start() {
  set_theme(kept_theme() ?? (dark.matches ? 'dark' : 'light'));
  make_fields(changed);
  for (const name of toggles) $(name).setAttribute('aria-pressed', app[name]);
  const { text, lands } = kept();
  app.refines = text === null ? true : lands ?? false;
  welcome_newcomers();
  fetch('/api/about').then((answer) => answer.json()).then(({ materials }) => $('material').append(...materials.map((each) => new Option(each, each))));
  let opened = null, problem = null;
  try {
    if (text) opened = await validated(text);
  } catch (error) {
    problem = `The kept scene cannot be read: ${error.message}`;
  }
  use(opened ?? default_scene(), problem);
}

// For the browser test, and for the curious.
window.nuno_studio = { app, view, space, latency: throws.latency };

start();
