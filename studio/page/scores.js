// The card of the arrival: how far off, at what force, and how quickly that was found.

import { digits, metres, seconds, steady } from './numbers.js';
import { crossing_words } from './sheet.js';
import { app, effort_unit, engine_names, engines, is_sheet, length_of, no_refining, other_engine, shows } from './state.js';

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
    <div class="what">of the cloth's ${is_sheet() ? 'size' : 'length'} off the target, on average</div>
    <dl><dt>mean error</dt><dd>${metres(error.mean)}</dd>
    <dt>worst particle</dt><dd>${metres(error.max)}</dd>
    <dt>centroid off by</dt><dd>${metres(error.centroid)}</dd>
    <dt>control effort</dt><dd>${digits(flight.control_effort)} ${effort_unit()}</dd>
    <dt>gain α</dt><dd>${digits(flight.alpha, 4)} N/m</dd></dl></div>`;
}

// What is left after refinement is rounding.
const percent = (share) => (share < 1e-8 ? '0.000' : steady(100 * share));

export function show_scores(throws) {
  const shown = engines().filter(shows);
  $('scores').className = shown.length > 1 ? 'two' : '';
  $('scores').innerHTML = shown.map((engine) => score(engine, throws)).join('');
  show_timing(throws);
  show_refining(throws);
  show_remarks();
}

function show_timing({ channels, latency }) {
  const { native } = app.results;
  const other = other_engine();
  const parts = [];
  if (native?.search) parts.push(`${native.search.evaluations} throws tried in ${seconds(native.search.seconds)}`);
  if (latency.median !== null) parts.push(`drawn ${digits(latency.median, 2)} ms after the pointer`);
  if (shows(other) && app.own_gain && app.alpha === null) {
    const { search } = app.results[other] ?? {};
    if (channels[other].busy) parts.push(`${engine_names[other]} searches…`);
    else if (search) parts.push(`${engine_names[other]}: ${search.evaluations} in ${seconds(search.seconds)}`);
  }
  $('timing').textContent = parts.join(' · ');
}

// The switch that lands exactly, or why there is none, and what it did.
function show_refining({ at_rest }) {
  const reason = no_refining();
  $('refine').disabled = reason !== '';
  $('refine').checked = app.refines && !reason;
  $('refine-set').hidden = !reason || app.engine !== 'native';
  const { flight } = app.results.native ?? {};
  const refinement = flight?.refinement;
  let text = 'The motion that the cloth follows is corrected, so that it lands on the target.';
  if (reason) {
    text = reason;
  } else if (app.refines && refinement) {
    const length = length_of(flight);
    const landed = refinement.status === 'converged'
      ? 'Landed exactly'
      : `As near as this cloth can come: ${digits((100 * flight.error.mean) / length)} % (${refinement.reason})`;
    text = `${landed}. The motion was corrected by up to ${metres(refinement.largest_offset)}; without that, ${digits((100 * refinement.error_before) / length)} %. ${refinement.rollouts} throws${refinement.jacobians > 0 ? ` and ${refinement.jacobians} Jacobian${refinement.jacobians > 1 ? 's' : ''}` : ''} in ${seconds(refinement.seconds)}.`;
  } else if (app.refines && !at_rest) {
    text = 'Lands exactly once you let go.';
  }
  if ($('refine-note').textContent !== text) $('refine-note').textContent = text;
}

// What stands in the way of a better throw, and where a sheet passes through things.
function show_remarks() {
  const { flight } = app.results.native ?? {};
  const remarks = flight ? [...flight.remarks.split('\n'), crossing_words(flight.crossings, length_of(flight))].filter(Boolean) : [];
  const text = remarks.join('\n');
  $('remarks').hidden = !text;
  if ($('remarks').textContent !== text) $('remarks').textContent = text;
}

let announced = '';
export function announce() {
  const { flight } = app.results.native ?? {};
  if (!flight) return;
  const text = `Error ${digits(100 * flight.error.relative)} percent of the cloth's ${is_sheet() ? 'size' : 'length'} at α ${digits(flight.alpha)}`;
  if (text !== announced) $('status').textContent = announced = text;
}
