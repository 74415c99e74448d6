// The card of the arrival: how far off, at what force, and how quickly that was found.

import { digits, metres, seconds, steady } from './numbers.js';
import { app, effort_unit, engine_names, engines, no_aiming, shows } from './state.js';

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

// What is left after aiming off is rounding.
const percent = (share) => (share < 1e-8 ? '0.000' : steady(100 * share));

export function show_scores(throws) {
  const shown = engines.filter(shows);
  $('scores').className = shown.length > 1 ? 'two' : '';
  $('scores').innerHTML = shown.map((engine) => score(engine, throws)).join('');
  show_timing(throws);
  show_aiming(throws);
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

// The control that aims off, or why there is none, and what it did.
function show_aiming({ at_rest }) {
  const reason = no_aiming();
  $('aim').disabled = reason !== '';
  $('aim').checked = app.aims_off && !reason;
  $('aim-set').hidden = !reason || app.engine !== 'native';
  const refinement = app.results.native?.flight?.refinement;
  let text = 'As an archer does in the wind: the throw aims beside the target, so that the cloth lands on it.';
  if (reason) {
    text = reason;
  } else if (app.aims_off && refinement) {
    const length = app.results.native.flight.cloth_length;
    text = `${refinement.status === 'converged' ? 'Arrived' : 'As near as it can come'}: aims up to ${metres(refinement.largest_offset)} off; straight at it, ${digits((100 * refinement.error_before) / length)} %. ${refinement.rollouts} throws and ${refinement.tangents} tangents in ${seconds(refinement.seconds)}.`;
  } else if (app.aims_off && !at_rest) {
    text = 'Aims off once you let go.';
  }
  if ($('aim-note').textContent !== text) $('aim-note').textContent = text;
}

let announced = '';
export function announce() {
  const { flight } = app.results.native ?? {};
  if (!flight) return;
  const text = `Error ${digits(100 * flight.error.relative)} percent of the cloth's length at α ${digits(flight.alpha)}`;
  if (text !== announced) $('status').textContent = announced = text;
}
