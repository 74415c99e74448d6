// The stage while the scene is a sheet: what of it the view in space shows, and the hand on its target.

import { metres } from './numbers.js';
import * as sheet from './sheet.js';
import { app, end_time, engines, length_of, scene, shows } from './state.js';
import { at_time } from './view.js';

const ghosts_shown = 6;
const least_error_shown = 1e-3; // of L: below it all is as good as right

const $ = (id) => document.getElementById(id);

// What is drawn of a flight, made once for as long as nothing else is asked for.
const made_of = new WeakMap();
function once(flight, what, key, make) {
  if (!made_of.has(flight)) made_of.set(flight, {});
  const kept = made_of.get(flight);
  if (kept[what]?.key !== key) kept[what] = { key, made: make() };
  return kept[what].made;
}

// The frame that is nearest to a time.
const nearest_frame = ({ times }, time) =>
  times.reduce((best, t, i) => (Math.abs(t - time) < Math.abs(times[best] - time) ? i : best), 0);

export class SpaceStage {
  // on: {changed(live, time), redraw()}
  constructor(on) {
    this.on = on;
    this.space = null; // once there is a sheet, and WebGL
    this.trouble = '';
  }

  get canvas() { return $('space'); }

  async open() {
    if (this.space || this.trouble) return;
    try {
      const { Space } = await import('./space.js');
      this.space ??= new Space(this.canvas, { draw: () => this.on.redraw(), moved: (matrix, live) => this.moved(matrix, live) });
    } catch (error) {
      this.trouble = `This browser shows nothing in space (WebGL): ${error.message}`;
    }
  }

  // What the gizmo did since it was taken.
  moved(matrix, live) {
    this.taken ??= scene().target.vertices;
    scene().target = { vertices: sheet.rounded_points(sheet.transformed(this.taken, matrix.elements)) };
    if (!live) this.taken = null;
    this.on.changed(live, performance.now());
  }

  key(event) {
    const moved = sheet.keyed(scene().target.vertices, event, this.length);
    if (!moved) return false;
    scene().target = { vertices: sheet.rounded_points(moved) };
    this.on.changed(false, event.timeStamp);
    return true;
  }

  get length() {
    const { flight } = app.results.native ?? {};
    return flight ? length_of(flight) : 1;
  }

  set_tool(tool) {
    this.space?.set_tool(tool);
  }

  fit() {
    if (!this.space) return;
    this.space.resize();
    const { flight } = app.results.native ?? {};
    const frames = flight && !this.taken
      ? flight.frames.positions.filter((_, i) => flight.frames.times[i] <= scene().arrival_time * (1 + 1e-9)) : [];
    this.space.fit([scene().initial.vertices, scene().target.vertices, ...frames], this.ground);
  }

  get ground() {
    const lowest = (points) => points.reduce((low, [, y]) => Math.min(low, y), 0);
    return Math.min(lowest(scene().initial.vertices), lowest(scene().target.vertices));
  }

  cloth_of(engine, colors) {
    const result = app.results[engine];
    if (!result?.flight || result.flight.final.length !== scene().initial.vertices.length) return null;
    const { flight } = result;
    const { frames } = flight;
    const at_arrival = app.time === null;
    const found = at_arrival ? null : once(flight, 'moment', app.time, () => at_time(frames, app.time));
    const color = engine === 'native' ? colors.a : colors.b;
    const cloth = {
      shape: found ? found.shape : flight.final, color, back: sheet.mixed(color, colors.ink, 0.25), stale: result.stale,
    };
    if (app.forces) {
      const last = frames.times.findLastIndex((t) => t <= scene().arrival_time * (1 + 1e-9));
      cloth.forces = found ? found.forces : frames.forces[last];
    }
    if (app.errors) {
      cloth.errors = once(flight, 'errors', color, () =>
        sheet.error_colors(flight.final, flight.target, Math.max(flight.error.max, least_error_shown * flight.size), sheet.shares_of(color), sheet.shares_of(colors.bad)));
    }
    const crossed = flight.crossings?.faces;
    if (crossed?.length) cloth.crossed = crossed[nearest_frame(frames, app.time ?? scene().arrival_time)];
    if (app.ghosts && frames.times.length > 1) {
      const until = at_arrival ? scene().arrival_time : end_time();
      cloth.ghosts = once(flight, 'ghosts', 0, () =>
        Array.from({ length: ghosts_shown - 1 }, (_, i) => at_time(frames, ((i + 1) / ghosts_shown) * scene().arrival_time).shape));
      cloth.path = once(flight, 'path', until, () => frames.positions.filter((_, i) => frames.times[i] <= until).map(sheet.middle));
    }
    return cloth;
  }

  draw(colors) {
    if (!this.space) return;
    const { initial, target } = scene();
    this.space.set_faces(initial.faces, initial.vertices.length);
    this.space.take(sheet.middle(target.vertices));
    const { flight } = app.results.native ?? {};
    const cloths = engines().filter(shows).map((engine) => this.cloth_of(engine, colors)).filter(Boolean);
    if (cloths.length > 1) cloths[1].wires = true; // or they hide one another where they are alike
    this.space.draw({
      start: initial.vertices, target: target.vertices, wires: app.wires, playing: app.playing, cloths,
      length: this.length, effort_unit: flight?.effort_unit ?? 1,
    }, colors);
    this.show_legend();
  }

  show_legend() {
    const { flight } = app.results.native ?? {};
    const shown = app.errors && flight;
    $('error-legend').hidden = !shown;
    if (shown) $('error-most').textContent = `${metres(Math.max(flight.error.max, least_error_shown * flight.size))} off`;
  }
}
