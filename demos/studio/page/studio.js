// The page: its state, what it asks the program, and what it shows.

import { Chart, minima } from './chart.js';
import { ask, Channel } from './client.js';
import { Editor } from './editor.js';
import * as geometry from './geometry.js';
import { default_scene, Document, file_text, kept_text } from './scene.js';
import { at_time, View } from './view.js';

const $ = (id) => document.getElementById(id);

const frames_while_dragging = 12;
const frames_per_second = 60;
const most_frames = 480;
const flight_after = 0.6; // of the arrival time, how long the cloth flies on
const ghosts_shown = 8;
const engine_names = { native: 'native', box2d: 'Box2D' };

// ---------------------------------------------------------------------------------- state

const app = {
  doc: null,
  selected: 'target',
  tool: 'move',
  vertex: null,
  engine: 'native', // native, box2d, over, side
  own_gain: false, // Box2D searches for itself
  alpha: null, // a gain tried by hand; null: the best
  results: {}, // by engine: {flight, curve, best, key}
  time: null, // of the flight [s]; null: the arrival
  playing: false,
  loop: true,
  after: true,
  ghosts: true,
  forces: false,
  speed: 1,
};

const channels = { native: new Channel('a'), box2d: new Channel('b'), curve: new Channel('c'), file: new Channel('f') };
const latencies = []; // of every pointer move: until an optimum that knows of it is drawn [ms]
let moves = []; // times of the moves whose optimum is not drawn yet

const scene = () => app.doc.scene;
const body = () => JSON.stringify(scene());
const shows = (engine) => app.engine === engine || app.engine === 'over' || app.engine === 'side';

// ---------------------------------------------------------------------------------- numbers

const digits = (x, n = 3) => {
  if (x === 0) return '0';
  const size = Math.abs(x);
  if (size >= 1e5 || size < 1e-4) return x.toExponential(1).replace('e-', 'e−').replace('e+', 'e');
  return Number(x.toPrecision(n)).toString();
};
// The same width while it changes.
const steady = (x) => (x >= 0.01 && x < 1000 ? Number(x.toPrecision(3)).toFixed(Math.max(0, 2 - Math.floor(Math.log10(x)))) : digits(x));
const metres = (x) => (x < 1e-6 ? '< 1 µm' : x < 1e-3 ? `${digits(1e6 * x, 2)} µm` : x < 1 ? `${digits(1e3 * x)} mm` : `${digits(x)} m`);
const seconds = (s) => (s < 1 ? `${digits(1e3 * s, 2)} ms` : `${digits(s, 2)} s`);
const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

// ---------------------------------------------------------------------------------- asking

// The scene has changed; live: it is still changing. `stamp` is the time of the event behind it.
function changed(live, stamp = null) {
  if (live) moves.push(stamp ?? performance.now());
  else {
    moves = [];
    app.doc.commit();
    update_fields();
  }
  request(live);
  redraw_soon();
}

function frame_count(live) {
  if (live) return frames_while_dragging;
  const most_by_size = Math.floor(300000 / scene().particles);
  return Math.max(2, Math.min(most_frames, most_by_size, Math.round(frames_per_second * scene().arrival_time * 2)));
}

function request(live) {
  const text = body();
  const frames = frame_count(live);
  const after = live ? 0 : flight_after * scene().arrival_time;
  const latest_move = live ? moves[moves.length - 1] : undefined;
  const failed = (engine) => (error) => {
    trouble(error.message);
    if (app.results[engine]) app.results[engine].stale = true;
    settle();
  };
  const json = async (path, parameters) => (await ask(path, parameters, text)).json();

  const take = (engine, flight) => {
    trouble(null);
    const result = (app.results[engine] ??= {});
    result.flight = flight;
    result.stale = false;
    result.key = text;
    if (flight.optimization) take_curve(engine, flight);
    show();
    if (engine === 'native' && latest_move !== undefined) {
      const drawn = performance.now();
      latencies.push(...moves.filter((time) => time <= latest_move).map((time) => drawn - time));
      moves = moves.filter((time) => time > latest_move);
      latencies.splice(0, latencies.length - 2000);
    }
    settle();
  };
  const take_curve = (engine, answer) => {
    const result = (app.results[engine] ??= {});
    result.curve = answer.optimization;
    result.curve_key = text;
    result.best = answer.alpha;
    result.best_error = answer.error.mean;
    result.length = answer.cloth_length;
    result.searched = answer.optimization.seconds;
  };

  // Box2D with the native gain waits for it.
  const ask_box2d = () => {
    if (!shows('box2d')) return;
    const alpha = app.alpha ?? (app.own_gain ? null : app.results.native?.best);
    if (live && alpha === null) {
      if (app.results.box2d) app.results.box2d.stale = true;
      return;
    }
    if (alpha === undefined) return;
    channels.box2d.run({
      work: (page) => alpha === null ? json('optimize', { page, backend: 'box2d', frames, after })
                                     : json('simulate', { page, backend: 'box2d', alpha, frames, after }),
      done: (answer) => take('box2d', answer),
      failed: failed('box2d'),
      urgent: !live,
    });
  };

  if (app.alpha === null) {
    channels.native.run({
      work: (page) => json('optimize', { page, frames, after }),
      done: (answer) => {
        take('native', answer);
        ask_box2d();
      },
      failed: failed('native'),
      urgent: !live,
    });
  } else {
    channels.native.run({
      work: (page) => json('simulate', { page, alpha: app.alpha, frames, after }),
      done: (answer) => take('native', answer),
      failed: failed('native'),
      urgent: !live,
    });
    if (app.results.native?.curve_key !== text) {
      channels.curve.run({
        work: (page) => json('optimize', { page }),
        done: (answer) => {
          take_curve('native', answer);
          show();
          settle();
        },
        failed: () => settle(),
        urgent: !live,
      });
    }
    ask_box2d();
  }
  // A Box2D search of an older scene is for nothing.
  if (!live && shows('box2d') && app.own_gain && app.results.box2d) app.results.box2d.stale = true;
  settle();
}

// For tests and for the pointer: whether an answer is still on its way.
let settle_due = 0;
function settle() {
  settle_due ||= setTimeout(() => {
    settle_due = 0;
    const busy = Object.values(channels).some((channel) => channel.busy);
    document.documentElement.dataset.busy = busy;
    if (busy) return;
    announce();
    show_scores();
  });
}

let announced = '';
function announce() {
  const { flight } = app.results.native ?? {};
  if (!flight) return;
  const text = `Error ${digits(100 * flight.error.relative)} percent of the cloth's length at α ${digits(flight.alpha)}`;
  if (text !== announced) $('status').textContent = announced = text;
}

let note_until = 0; // a note about the scene itself stays for a while
function trouble(message, stay = 0) {
  if (!message && performance.now() < note_until) return;
  note_until = performance.now() + stay;
  $('trouble').hidden = !message;
  if (message) $('trouble').textContent = message.replace(/^scene\.json: /, '');
}

// ---------------------------------------------------------------------------------- drawing

const stage = $('stage');
const view = new View(stage);
let colors = {};

function read_colors() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ['paper', 'panel', 'line', 'ink', 'quiet', 'faint', 'grid', 'axis', 'initial', 'target', 'a', 'b', 'force']) {
    colors[name] = style.getPropertyValue(`--${name}`).trim();
  }
}

const end_time = () => (app.after ? 1 + flight_after : 1) * scene().arrival_time;
const now = () => app.time ?? scene().arrival_time;

function cloth_of(engine) {
  const result = app.results[engine];
  if (!result?.flight) return null;
  const { flight } = result;
  const color = engine === 'native' ? colors.a : colors.b;
  const cloth = { color, effort_unit: flight.effort_unit, stale: result.stale };
  const { frames } = flight;
  const at_arrival = app.time === null;
  const found = at_arrival ? null : at_time(frames, app.time);
  cloth.shape = found ? found.shape : flight.final;
  if (app.forces) {
    if (found) cloth.forces = found.forces;
    else {
      const last = frames.times.findLastIndex((t) => t <= scene().arrival_time * (1 + 1e-9));
      cloth.forces = frames.forces[last];
    }
  }
  if (app.ghosts && frames.times.length > 1) {
    const until = at_arrival ? scene().arrival_time : end_time();
    cloth.ghosts = Array.from({ length: ghosts_shown - 1 }, (_, i) =>
      at_time(frames, ((i + 1) / ghosts_shown) * scene().arrival_time).shape);
    cloth.path = frames.positions.filter((_, i) => frames.times[i] <= until).map(geometry.mean);
  }
  return cloth;
}

// The target as it is thrown at: known at once, before the program answers.
function fitted_target() {
  const { initial, target, target_length } = scene();
  if (target_length !== 'fit') return null;
  const factor = geometry.length(initial) / geometry.length(target);
  return Math.abs(factor - 1) < 0.004 || !Number.isFinite(factor) ? null : geometry.scaled(target, factor);
}

// Once a frame, however often the pointer moves in it; an answer draws at once.
let redraw_due = 0;
function redraw_soon() {
  redraw_due ||= requestAnimationFrame(redraw);
}

function redraw() {
  cancelAnimationFrame(redraw_due);
  redraw_due = 0;
  const engines = ['native', 'box2d'].filter(shows);
  const cloths = Object.fromEntries(engines.map((engine) => [engine, cloth_of(engine)]));
  const views = app.engine === 'side'
    ? engines.map((engine) => ({ title: engine_names[engine], cloths: [cloths[engine]].filter(Boolean) }))
    : [{ cloths: engines.map((engine) => cloths[engine]).filter(Boolean) }];
  const { initial, target } = scene();
  view.draw({
    views, initial, target, fitted: fitted_target(), selected: app.selected,
    tool: app.playing ? null : app.tool, vertex: app.vertex,
    stroke: editor.gesture?.kind === 'draw' ? editor.gesture.points : null,
    forces: app.forces ? (scene().gravity > 0 ? 'a particle’s weight' : 'm·L/t₀²') : null,
  }, colors);
  show_hint();
  show_clock();
}

function show() {
  redraw();
  draw_chart();
  if (!app.playing || app.time === null) show_scores();
}

function draw_chart() {
  chart.curves = ['native', 'box2d'].flatMap((engine) => {
    const result = app.results[engine];
    if (!result?.curve || (engine === 'box2d' && (!shows('box2d') || !app.own_gain || result.stale))) return [];
    return [{ history: result.curve.history, length: result.length, best: result.best, color: engine === 'native' ? colors.a : colors.b }];
  });
  const { native } = app.results;
  chart.alpha = app.alpha ?? (app.engine === 'box2d' && app.own_gain ? app.results.box2d?.flight?.alpha : native?.best) ?? null;
  chart.draw(colors);
  $('best').hidden = app.alpha === null;
  if (!native?.curve) return;
  const dips = minima(native.curve.history);
  const launch_only = native.curve.history.find((s) => s.alpha === 0);
  $('chart-note').textContent =
    (app.alpha === null ? 'Drag along the curve to try another α. ' : `Trying α = ${digits(app.alpha, 4)} N/m; best ${digits(native.best, 4)}. `) +
    (dips.length > 1 ? `${dips.length} minima.` : 'One minimum.') +
    (launch_only ? ` Without control ${digits((100 * launch_only.error) / native.length)} %.` : '');
  const slider = $('chart');
  slider.setAttribute('aria-valuemin', 0);
  slider.setAttribute('aria-valuemax', chart.range[1]);
  slider.setAttribute('aria-valuenow', chart.alpha ?? 0);
  slider.setAttribute('aria-valuetext', `${digits(chart.alpha ?? 0)} newton per metre`);
}

function score(engine) {
  const result = app.results[engine];
  const both = app.engine === 'over' || app.engine === 'side';
  const who = both ? `<div class="who"><i class="dot ${engine === 'native' ? 'a' : 'b'}"></i>${engine_names[engine]}</div>` : '';
  if (!result?.flight) return `<div class="score stale">${who}<div class="big">…</div><div class="what">under way</div></div>`;
  const { flight } = result;
  const { error } = flight;
  const effort = scene().gravity > 0 ? '× weight' : '× m·L/t₀²';
  const stale = result.stale || (channels[engine].busy && result.key !== app.doc.committed && !moves.length);
  return `<div class="score${stale ? ' stale' : ''}">${who}
    <div class="big" data-engine="${engine}">${steady(100 * error.relative)} <small>%</small></div>
    <div class="what">of the cloth's length off the target, on average</div>
    <dl><dt>mean error</dt><dd>${metres(error.mean)}</dd>
    <dt>worst particle</dt><dd>${metres(error.max)}</dd>
    <dt>centroid off by</dt><dd>${metres(error.centroid)}</dd>
    <dt>control effort</dt><dd>${digits(flight.control_effort)} ${effort}</dd>
    <dt>gain α</dt><dd>${digits(flight.alpha, 4)} N/m</dd></dl></div>`;
}

function show_scores() {
  const engines = ['native', 'box2d'].filter(shows);
  $('scores').className = engines.length > 1 ? 'two' : '';
  $('scores').innerHTML = engines.map(score).join('');
  const { native, box2d } = app.results;
  const parts = [];
  if (native?.curve) parts.push(`${native.curve.evaluations} throws tried in ${seconds(native.searched)}`);
  if (latencies.length) parts.push(`drawn ${digits(median(latencies.slice(-60)), 2)} ms after the pointer`);
  let text = parts.join(' · ');
  if (shows('box2d') && channels.box2d.busy && app.own_gain && app.alpha === null) text += ' · Box2D searches…';
  else if (shows('box2d') && app.own_gain && box2d?.curve && app.alpha === null) text += ` · Box2D: ${box2d.curve.evaluations} in ${seconds(box2d.searched)}`;
  $('timing').textContent = text;
}

function show_hint() {
  const { initial, target, target_length } = scene();
  const cloth = geometry.length(initial), drawn = geometry.length(target);
  let text;
  if (editor.gesture?.kind === 'draw') {
    const far = geometry.length(editor.gesture.points);
    text = app.selected === 'target' ? `${digits(far)} m drawn; the cloth is ${digits(cloth)} m` : `${digits(far)} m of cloth`;
  } else if (app.time !== null && app.time > scene().arrival_time * 1.0001) {
    text = 'After arrival nothing controls the cloth: it flies on.';
  } else if (app.tool === 'draw') {
    text = `Draw the ${app.selected} shape in one stroke.`;
  } else if (Math.abs(drawn / cloth - 1) >= 0.004) {
    text = target_length === 'fit'
      ? `The target is drawn ${digits(drawn)} m long, the cloth is ${digits(cloth)} m: it is scaled by ${digits(cloth / drawn)} (dotted: as drawn).`
      : `The target is ${digits(drawn)} m long and left as drawn, the cloth is ${digits(cloth)} m: it cannot cover it exactly.`;
  } else if (app.tool === 'points') {
    text = 'Drag a point; its neighbours follow. With Shift it moves alone.';
  } else if (app.tool === 'pan') {
    text = 'Drag to pan, scroll or pinch to zoom.';
  } else {
    text = `Drag the ${app.selected}: the best throw follows.`;
  }
  if ($('hint').textContent !== text) $('hint').textContent = text;
}

// ---------------------------------------------------------------------------------- flight

function show_clock() {
  const t0 = scene().arrival_time;
  const slider = $('time');
  const share = Math.min(1, now() / end_time());
  slider.value = Math.round(1000 * share);
  slider.setAttribute('aria-valuetext', `${now().toFixed(2)} of ${t0.toFixed(2)} seconds`);
  const text = `${now().toFixed(2)} / ${digits(t0)} s`;
  if ($('clock').textContent !== text) $('clock').textContent = text;
  const mark = Math.min(1, t0 / end_time());
  $('arrival-mark').style.left = `calc(${100 * mark}% + ${8 - 16 * mark - 1}px)`;
}

let last_tick = 0;
function tick(stamp) {
  if (!app.playing) return;
  const end = end_time();
  const passed = Math.min(0.1, (stamp - last_tick) / 1000);
  last_tick = stamp;
  app.time = (app.time ?? 0) + passed * app.speed;
  if (app.time >= end + (app.loop ? 0.35 * app.speed : 0)) {
    if (app.loop) app.time = 0;
    else return play(false);
  }
  const shown = app.time;
  app.time = Math.min(app.time, end);
  redraw();
  app.time = shown;
  requestAnimationFrame(tick);
}

function play(on) {
  app.playing = on;
  if (on && (app.time === null || app.time >= end_time())) app.time = 0;
  if (!on && app.time !== null && app.time > end_time()) app.time = end_time();
  $('play-icon').setAttribute('d', on ? 'M8 5v14M16 5v14' : 'M8 5v14l11-7z');
  $('play-icon').setAttribute('stroke-width', on ? 3.5 : 1.7);
  $('play').setAttribute('aria-label', on ? 'Pause' : 'Play');
  last_tick = performance.now();
  if (on) requestAnimationFrame(tick);
  redraw();
}

function go_to(time) {
  play(false);
  const t0 = scene().arrival_time;
  app.time = Math.max(0, Math.min(end_time(), time));
  if (Math.abs(app.time - t0) < 0.006 * t0) app.time = null; // the mark holds
  redraw();
}

// ---------------------------------------------------------------------------------- fields

// A slider's travel: logarithmic where values span decades; `zero` adds 0 at its left end.
const fields = {
  'throw-sliders': [
    { path: 'arrival_time', label: 'Arrival time t₀', unit: 's', low: 0.2, high: 4, log: true },
    { path: 'gravity', label: 'Gravity', unit: 'm/s²', low: 0, high: 20, step: 0.1 },
    { path: 'particles', label: 'Particles', unit: '', low: 3, high: 128, step: 1 },
  ],
  'cloth-sliders': [
    { path: 'cloth.mass', label: 'Mass', unit: 'kg', low: 0.01, high: 2, log: true },
    { path: 'cloth.air_drag', label: 'Air drag', unit: 'kg/s', low: 0.001, high: 1, log: true, zero: true },
    { path: 'cloth.stretch_stiffness', label: 'Stretch stiffness', unit: 'N', low: 5, high: 5000, log: true },
    { path: 'cloth.stretch_damping', label: 'Stretch damping', unit: 'N·s', low: 1e-5, high: 0.1, log: true, zero: true },
    { path: 'cloth.hinge_stiffness', label: 'Hinge stiffness', unit: 'N·m²', low: 1e-5, high: 0.1, log: true, zero: true },
    { path: 'cloth.hinge_damping', label: 'Hinge damping', unit: 'N·m²·s', low: 1e-6, high: 1e-3, log: true, zero: true },
  ],
  'control-fields': [
    { path: 'reference', label: 'Pulls towards', words: { hold: 'the target (hold)', morph: 'a motion to it (morph)' } },
    { path: 'arrival', label: 'Motion arrives', words: { pass: 'in full swing', settle: 'at rest' }, when: (s) => s.reference === 'morph' },
    { path: 'damping_ratio', label: 'Damping ratio ζ', unit: '', low: 0, high: 2, step: 0.01 },
    { path: 'launch', label: 'Launch', words: { ballistic: 'ballistic', inextensible: 'inextensible' } },
    { path: 'target_length', label: 'Target length', words: { fit: 'fit to the cloth', 'as-drawn': 'as drawn' } },
  ],
};
const slider_steps = 500;

const read_field = (path) => path.split('.').reduce((object, key) => object?.[key], scene());
function write_field(path, value) {
  const keys = path.split('.');
  const last = keys.pop();
  keys.reduce((object, key) => (object[key] ??= {}), scene())[last] = value;
}

function to_travel(field, value) {
  const { low, high, log, zero } = field;
  if (!log) return (slider_steps * (value - low)) / (high - low);
  if (!(value > 0)) return 0;
  const first = zero ? 20 : 0;
  return Math.max(first, first + ((slider_steps - first) * Math.log(value / low)) / Math.log(high / low));
}
function from_travel(field, travel) {
  const { low, high, log, zero, step } = field;
  if (!log) return Number((Math.round((low + (travel / slider_steps) * (high - low)) / step) * step).toPrecision(6));
  const first = zero ? 20 : 0;
  if (zero && travel < first / 2) return 0;
  return Number((low * (high / low) ** Math.max(0, (travel - first) / (slider_steps - first))).toPrecision(3));
}

function make_fields() {
  for (const [id, list] of Object.entries(fields)) {
    for (const field of list) {
      const row = document.createElement('div');
      row.className = 'field';
      const name = `field-${field.path.replace('.', '-')}`;
      if (field.words) {
        row.innerHTML = `<label for="${name}">${field.label}</label><select id="${name}">${
          Object.entries(field.words).map(([value, text]) => `<option value="${value}">${text}</option>`).join('')}</select>`;
        row.querySelector('select').addEventListener('change', (event) => {
          write_field(field.path, event.target.value);
          changed(false);
        });
      } else {
        row.innerHTML = `<label for="${name}">${field.label}</label><input type="number" id="${name}" step="any"><span class="unit">${field.unit}</span>
          <input type="range" min="0" max="${slider_steps}" aria-label="${field.label}">`;
        const [number, range] = row.querySelectorAll('input');
        number.addEventListener('change', () => {
          const value = Number(number.value);
          if (number.value.trim() === '' || !Number.isFinite(value)) return update_fields();
          write_field(field.path, value);
          changed(false);
        });
        range.addEventListener('input', () => {
          write_field(field.path, from_travel(field, Number(range.value)));
          number.value = read_field(field.path);
          range.setAttribute('aria-valuetext', `${number.value} ${field.unit}`);
          changed(true, performance.now());
        });
        range.addEventListener('change', () => changed(false));
      }
      field.row = row;
      $(id).append(row);
    }
  }
}

function update_fields() {
  for (const list of Object.values(fields)) {
    for (const field of list) {
      const value = read_field(field.path);
      field.row.hidden = field.when ? !field.when(scene()) : false;
      if (field.words) field.row.querySelector('select').value = value;
      else {
        const [number, range] = field.row.querySelectorAll('input');
        number.value = value;
        if (document.activeElement !== range || editor.gesture) range.value = to_travel(field, value);
        range.setAttribute('aria-valuetext', `${value} ${field.unit}`);
      }
    }
  }
  const { cloth, reference, damping_ratio, launch } = scene();
  $('cloth-note').textContent = `${digits(cloth.mass)} kg, ${digits(geometry.length(scene().initial))} m`;
  $('control-note').textContent = [reference, damping_ratio ? `ζ ${digits(damping_ratio)}` : '', launch].filter(Boolean).join(', ');
  if (document.activeElement !== $('name')) $('name').value = scene().name ?? '';
  document.title = `${scene().name || 'untitled'} – nuno studio`;
  $('undo').disabled = !app.doc.past.length;
  $('redo').disabled = !app.doc.future.length;
  $('snap').title = app.selected === 'target' ? "Give the target the cloth's length (L)" : "Give the cloth the target's length (L)";
}

// ---------------------------------------------------------------------------------- actions

function select(name) {
  app.selected = name;
  app.vertex = null;
  for (const each of ['initial', 'target']) {
    $(`select-${each}`).setAttribute('aria-checked', each === name);
    $(`select-${each}`).tabIndex = each === name ? 0 : -1;
  }
  update_fields();
  redraw();
}

function set_tool(name) {
  app.tool = name;
  for (const each of ['move', 'draw', 'points', 'pan']) $(`tool-${each}`).setAttribute('aria-pressed', each === name);
  if (app.playing && name !== 'pan') play(false);
  redraw();
}

function set_engine(name) {
  app.engine = name;
  for (const each of ['native', 'box2d', 'over', 'side']) {
    $(`engine-${each}`).setAttribute('aria-checked', each === name);
    $(`engine-${each}`).tabIndex = each === name ? 0 : -1;
  }
  $('own-row').hidden = name === 'native';
  view.views = name === 'side' ? 2 : 1;
  fit_view();
  request(false);
  show();
  show_scores();
}

function reshape(line) {
  scene()[app.selected] = geometry.rounded(line);
  app.vertex = null;
  changed(false);
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
  'fit-view': () => { fit_view(); redraw(); },
  best: () => try_gain(null, false),
  loop: () => toggle('loop'),
  after: () => toggle('after'),
  ghosts: () => toggle('ghosts'),
  forces: () => toggle('forces'),
  play: () => play(!app.playing),
};

function step_history(done) {
  if (!done) return;
  app.vertex = null;
  moves = [];
  update_fields();
  request(false);
  redraw();
}

function toggle(name) {
  app[name] = !app[name];
  $(name).setAttribute('aria-pressed', app[name]);
  if (name === 'after' && now() > end_time()) app.time = null;
  redraw();
}

function try_gain(alpha, live) {
  const was = app.alpha;
  app.alpha = alpha;
  if (was === null && alpha === null) return;
  request(live);
  draw_chart();
}

function fit_view() {
  const { initial, target } = scene();
  const lines = [initial, target, fitted_target() ?? target];
  const flight = app.results.native?.flight;
  if (flight && app.results.native.key === app.doc.committed) {
    const { times, positions } = flight.frames;
    lines.push(...positions.filter((_, i) => times[i] <= scene().arrival_time));
  }
  view.fit(lines);
}

function use(new_scene, text_of_problem) {
  if (app.doc) {
    app.doc.scene = new_scene;
    app.doc.commit();
  } else {
    app.doc = new Document(new_scene);
  }
  app.alpha = null;
  app.results = {};
  app.time = null;
  play(false);
  app.vertex = null;
  select('target');
  set_tool('move');
  set_engine(app.engine);
  if (text_of_problem) trouble(text_of_problem, 8000);
  channels_idle_then(() => { fit_view(); redraw(); });
}

// Once the first flight is there, its whole path is in view.
function channels_idle_then(act) {
  const wait = () => (app.results.native?.flight ? act() : tries-- > 0 && setTimeout(wait, 30));
  let tries = 100;
  wait();
}

async function open_text(text, name) {
  try {
    const opened = await (await ask('scene', {}, text)).json();
    if (!JSON.parse(text).name && name) opened.name = name.replace(/\.json$/i, '');
    use(opened);
    return true;
  } catch (error) {
    trouble(`${name ? `${name}: ` : ''}${error.message.replace(/^scene\.json: /, '')}`);
    return false;
  }
}

function download(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const file_name = () => (scene().name || 'scene').replace(/[^\p{L}\p{N} ._-]/gu, '-');

function save() {
  download(new Blob([file_text(scene())], { type: 'application/json' }), `${file_name()}.json`);
}

async function save_made(path, ending, button) {
  $('export').open = false;
  const engine = app.engine === 'box2d' ? 'box2d' : 'native';
  const alpha = app.alpha ?? (engine === 'box2d' && !app.own_gain ? app.results.native?.best : null);
  const parameters = { backend: engine, ...(alpha === null || alpha === undefined ? {} : { alpha }) };
  const label = button.textContent;
  button.disabled = true;
  $('status').textContent = `${label} is being made`;
  try {
    const response = await ask(path, { page: channels.file.page, ...parameters }, body());
    download(await response.blob(), `${file_name()}${ending}`);
  } catch (error) {
    trouble(error.message);
  }
  button.disabled = false;
}

function new_scene() {
  use({ ...default_scene() });
}

// ---------------------------------------------------------------------------------- wiring

const editor_app = {
  get doc() { return app.doc; },
  get selected() { return app.selected; },
  get tool() { return app.tool; },
  get vertex() { return app.vertex; },
  set vertex(index) { app.vertex = index; },
  changed: (live, stamp) => {
    // What follows the hand is how the cloth arrives.
    if (app.playing) play(false);
    if (live) app.time = null;
    changed(live, stamp);
  },
  select, redraw: redraw_soon,
  drawn: () => {
    if (app.playing) play(false);
    app.time = null;
    set_tool('move');
    changed(false);
  },
};
const editor = new Editor(stage, view, editor_app);
const chart = new Chart($('chart'), try_gain);

for (const [id, act] of Object.entries(actions)) $(id).addEventListener('click', () => act());
for (const name of ['initial', 'target']) $(`select-${name}`).addEventListener('click', () => select(name));
for (const name of ['move', 'draw', 'points', 'pan']) $(`tool-${name}`).addEventListener('click', () => set_tool(name));
for (const name of ['native', 'box2d', 'over', 'side']) $(`engine-${name}`).addEventListener('click', () => set_engine(name));
for (const group of document.querySelectorAll('[role="radiogroup"]')) {
  group.addEventListener('keydown', (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const buttons = [...group.querySelectorAll('[role="radio"]')];
    const next = buttons[(buttons.indexOf(document.activeElement) + step + buttons.length) % buttons.length];
    next.click();
    next.focus();
  });
}
$('own').addEventListener('change', (event) => {
  app.own_gain = event.target.checked;
  request(false);
  show();
});
$('preset').append(new Option('Shapes', ''), ...Object.entries(geometry.presets).map(([name, { label }]) => new Option(label, name)));
$('preset').addEventListener('change', (event) => {
  const wanted = geometry.length(scene().initial);
  reshape(geometry.preset(event.target.value, geometry.centroid(selected_line()), wanted));
  event.target.value = '';
});
$('time').addEventListener('input', (event) => go_to((Number(event.target.value) / 1000) * end_time()));
$('speed').addEventListener('change', (event) => (app.speed = Number(event.target.value)));
$('name').addEventListener('input', (event) => (scene().name = event.target.value));
$('name').addEventListener('change', () => { app.doc.commit(); update_fields(); });
$('name').addEventListener('keydown', (event) => (event.key === 'Enter' || event.key === 'Escape') && event.target.blur());
$('new').addEventListener('click', new_scene);
$('save').addEventListener('click', save);
$('open').addEventListener('click', () => $('file').click());
$('file').addEventListener('change', async (event) => {
  const [file] = event.target.files;
  event.target.value = '';
  if (file) await open_text(await file.text(), file.name);
});
$('save-result').addEventListener('click', (event) => save_made('result', '-result.json', event.currentTarget));
$('save-report').addEventListener('click', (event) => save_made('report', '-report.html', event.currentTarget));
$('save-film').addEventListener('click', (event) => save_made('film', '.mp4', event.currentTarget));
$('help').addEventListener('click', () => $('help-dialog').showModal());
document.addEventListener('click', (event) => {
  if (!$('export').contains(event.target)) $('export').open = false;
});
stage.addEventListener('dragover', (event) => event.preventDefault());
stage.addEventListener('drop', async (event) => {
  event.preventDefault();
  const [file] = event.dataTransfer.files;
  if (file) await open_text(await file.text(), file.name);
});

const key_actions = {
  1: () => select('initial'), 2: () => select('target'),
  v: () => set_tool('move'), d: () => set_tool('draw'), p: () => set_tool('points'), h: () => set_tool('pan'),
  r: actions.reverse, f: actions['flip-x'], F: actions['flip-y'], l: actions.snap,
  0: actions['fit-view'], o: actions.loop, a: actions.after, g: actions.ghosts, c: actions.forces,
  e: () => set_engine({ native: 'box2d', box2d: 'over', over: 'side', side: 'native' }[app.engine]),
  ',': () => go_to(now() - 1 / frames_per_second), '.': () => go_to(now() + 1 / frames_per_second),
  '?': () => $('help-dialog').showModal(),
};
let space_used = false;
document.addEventListener('keydown', (event) => {
  if ($('help-dialog').open) return;
  const command = event.ctrlKey || event.metaKey;
  const typing = event.target.matches('input:not([type="range"]):not([type="checkbox"]), select');
  if (command && !typing) {
    const key = event.key.toLowerCase();
    const act = { z: event.shiftKey ? actions.redo : actions.undo, y: actions.redo, s: save, o: () => $('file').click() }[key];
    if (act) {
      event.preventDefault();
      act();
    }
    return;
  }
  if (command || event.altKey && !event.key.startsWith('Arrow') || typing) return;
  if (event.key === 'Escape') {
    set_tool('move');
    return;
  }
  const on_control = event.target.matches('button, input, summary');
  if (event.key === ' ') {
    if (on_control) return;
    event.preventDefault();
    if (!event.repeat) {
      editor.space = true;
      space_used = false;
    }
    return;
  }
  if (!(on_control && event.key.startsWith('Arrow')) && editor.key(event)) return event.preventDefault();
  const act = key_actions[event.key] ?? key_actions[event.key.toLowerCase()];
  if (act) {
    event.preventDefault();
    act();
  }
});
stage.addEventListener('pointerdown', () => (space_used = true));
document.addEventListener('keyup', (event) => {
  if (event.key !== ' ' || !editor.space) return;
  editor.space = false;
  if (!space_used) play(!app.playing);
});
addEventListener('blur', () => (editor.space = false));

const dark = matchMedia('(prefers-color-scheme: dark)');
function set_theme(name) {
  document.documentElement.dataset.theme = name;
  read_colors();
  if (app.doc) show();
}
function kept_theme() {
  try { return localStorage.getItem('nuno-studio-theme'); } catch { return null; }
}
dark.addEventListener('change', () => kept_theme() || set_theme(dark.matches ? 'dark' : 'light'));
$('theme').addEventListener('click', () => {
  const next = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
  try { localStorage.setItem('nuno-studio-theme', next); } catch { /* for this visit only */ }
  set_theme(next);
});

new ResizeObserver(() => {
  const was = view.width;
  view.resize();
  if (!app.doc) return;
  if (was < 10) fit_view();
  redraw();
}).observe(stage);
new ResizeObserver(() => app.doc && draw_chart()).observe($('chart'));
addEventListener('hashchange', () => {
  const text = kept_text();
  if (text && text !== app.doc.committed) open_text(text);
});

async function start() {
  set_theme(kept_theme() ?? (dark.matches ? 'dark' : 'light'));
  make_fields();
  for (const name of ['loop', 'after', 'ghosts', 'forces']) $(name).setAttribute('aria-pressed', app[name]);
  const text = kept_text();
  let opened = null, problem = null;
  try {
    if (text) opened = await (await ask('scene', {}, text)).json();
  } catch (error) {
    problem = `The kept scene cannot be read: ${error.message}`;
  }
  use(opened ?? default_scene(), problem);
}

// For the browser test, and for the curious.
window.nuno_studio = { app, view, latencies, redraw, show, median: () => median(latencies) };

start();
