// The card of the arrival: how far off, at what force, and how quickly that was found.

import { digits, metres, seconds, steady } from './numbers.js';
import { app, effort_unit, engine_names, engines, no_refining, shows } from './state.js';

const $ = (id) => document.getElementById(id);

function score(engine, throws) {
  const result = app.results[engine];
  const both = app.engine === 'over' || app.engine === 'side';
  const who = both ? `<div class="who"><i class="dot ${engine === 'native' ? 'a' : 'b'}"></i>${engine_names[engine]}</div>` : '';
  if (!result?.flight) return `<div class="score stale">${who}<div class="big">…</div><div class="what">under way</div></div>`;
  const { flight } = result;
  const { error } = flight;
  const awaited = throws.at_rest && throws.channels[engine].busy && result.key !== app.doc.committed;
  return `<div class="score${result.stale || awaited ? ' stale' : ''}">${who}
    <div class="big" data-engine="${engine}">${percent(error.relative)} <small>%</small></div>
    <div class="what">of the cloth's length off the target, on average</div>
    <dl><dt>mean error</dt><dd>${metres(error.mean)}</dd>
    <dt>worst particle</dt><dd>${metres(error.max)}</dd>
    <dt>centroid off by</dt><dd>${metres(error.centroid)}</dd>
    <dt>control effort</dt><dd>${digits(flight.control_effort)} ${effort_unit()}</dd>
    <dt>gain α</dt><dd>${digits(flight.alpha, 4)} N/m</dd></dl></div>`;
}

// What is left after refinement is rounding.
const percent = (share) => (share < 1e-8 ? '0.000' : steady(100 * share));

export function show_scores(throws) {
  const shown = engines.filter(shows);
  $('scores').className = shown.length > 1 ? 'two' : '';
  $('scores').innerHTML = shown.map((engine) => score(engine, throws)).join('');
  show_timing(throws);
  show_refining(throws);
}

function show_timing({ channels, latency }) {
  const { native, box2d } = app.results;
  const parts = [];
  if (native?.search) parts.push(`${native.search.evaluations} throws tried in ${seconds(native.search.seconds)}`);
  if (latency.median !== null) parts.push(`drawn ${digits(latency.median, 2)} ms after the pointer`);
  if (shows('box2d') && app.own_gain && app.alpha === null) {
    if (channels.box2d.busy) parts.push('Box2D searches…');
    else if (box2d?.search) parts.push(`Box2D: ${box2d.search.evaluations} in ${seconds(box2d.search.seconds)}`);
  }
  $('timing').textContent = parts.join(' · ');
}

// The control that refines, or why there is none, and what it did.
function show_refining({ at_rest }) {
  const reason = no_refining();
  $('refine').disabled = reason !== '';
  $('refine').checked = app.refines && !reason;
  $('refine-set').hidden = !reason || app.engine !== 'native';
  const refinement = app.results.native?.flight?.refinement;
  let text = 'The motion that the cloth follows is corrected, so that the cloth lands on the target.';
  if (reason) {
    text = reason;
  } else if (app.refines && refinement) {
    const length = app.results.native.flight.cloth_length;
    text = `${refinement.status === 'converged' ? 'Arrived' : 'As near as it can come'}: corrected by up to ${metres(refinement.largest_offset)}; straight at it, ${digits((100 * refinement.error_before) / length)} %. ${refinement.rollouts} throws and ${refinement.jacobians} Jacobians in ${seconds(refinement.seconds)}.`;
  } else if (app.refines && !at_rest) {
    text = 'Lands exactly once you let go.';
  }
  if ($('refine-note').textContent !== text) $('refine-note').textContent = text;
}

let announced = '';
export function announce() {
  const { flight } = app.results.native ?? {};
  if (!flight) return;
  const text = `Error ${digits(100 * flight.error.relative)} percent of the cloth's length at α ${digits(flight.alpha)}`;
  if (text !== announced) $('status').textContent = announced = text;
}
