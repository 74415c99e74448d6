// What the stage shows: both shapes, and the cloths in flight.

import * as geometry from './geometry.js';
import { app, end_time, engine_names, engines, scene, shows } from './state.js';
import { at_time } from './view.js';

const ghosts_shown = 8;

function cloth_of(engine, colors) {
  const result = app.results[engine];
  if (!result?.flight) return null;
  const { flight } = result;
  const { frames } = flight;
  const at_arrival = app.time === null;
  const found = at_arrival ? null : at_time(frames, app.time);
  const cloth = {
    color: engine === 'native' ? colors.a : colors.b, effort_unit: flight.effort_unit, stale: result.stale,
    shape: found ? found.shape : flight.final,
  };
  if (app.forces) {
    const last = frames.times.findLastIndex((t) => t <= scene().arrival_time * (1 + 1e-9));
    cloth.forces = found ? found.forces : frames.forces[last];
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

// `stroke`: what is being drawn, or null.
export function draw_stage(view, colors, stroke) {
  const shown = engines().filter(shows);
  const cloths = Object.fromEntries(shown.map((engine) => [engine, cloth_of(engine, colors)]));
  const views = app.engine === 'side'
    ? shown.map((engine) => ({ title: engine_names[engine], cloths: [cloths[engine]].filter(Boolean) }))
    : [{ cloths: shown.map((engine) => cloths[engine]).filter(Boolean) }];
  const { initial, target, gravity } = scene();
  view.draw({
    views, initial, target, stroke, fitted: fitted_target(), selected: app.selected,
    tool: app.playing ? null : app.tool, vertex: app.vertex,
    forces: app.forces ? (gravity > 0 ? 'a particle’s weight' : 'm·L/t₀²') : null,
  }, colors);
}

// Everything is in view, the way of the cloth too.
export function fit_view(view) {
  const { initial, target } = scene();
  const lines = [initial, target, fitted_target() ?? target];
  const { flight, key } = app.results.native ?? {};
  if (flight && key === app.doc.committed) {
    const { times, positions } = flight.frames;
    lines.push(...positions.filter((_, i) => times[i] <= scene().arrival_time));
  }
  view.fit(lines);
}
