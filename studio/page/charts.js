// The two charts: E(α), and what error costs in effort.

import { Chart } from './chart.js';
import { digits } from './numbers.js';
import { app, effort_unit, engines, other_engine, shows } from './state.js';

const $ = (id) => document.getElementById(id);

// The dips of a curve.
function minima(points) {
  const found = [];
  for (let i = 0; i < points.length; i++) {
    const { y } = points[i];
    let left = i - 1, right = i + 1;
    while (left >= 0 && points[left].y === y) left--;
    while (right < points.length && points[right].y === y) right++;
    const falls = left < 0 || points[left].y > y;
    const rises = right >= points.length || points[right].y > y;
    if (falls && rises && left === i - 1) found.push(points[i]);
  }
  // A dip is one if the way to the next one leads over something: a refined valley is sampled to the
  // last digits, where noise has minima of its own.
  const dips = [];
  for (const dip of found) {
    const last = dips.at(-1);
    const between = last ? points.filter(({ x }) => x > last.x && x < dip.x) : [];
    const pass = Math.max(0, ...between.map(({ y }) => y));
    if (last && pass < 1.01 * Math.max(last.y, dip.y)) {
      if (dip.y < last.y) dips[dips.length - 1] = dip;
    } else {
      dips.push(dip);
    }
  }
  return dips;
}

export class Charts {
  // `on_try(α, live)` as of a Chart.
  constructor(on_try) {
    this.gain = new Chart($('gain-chart'), 'values', on_try);
    this.pareto = new Chart($('pareto-chart'), 'points', on_try);
    this.drawn_curves = new WeakMap(); // of answers: their points and dips, made once
  }

  draw(colors) {
    this.draw_gain(colors);
    this.draw_pareto(colors);
    for (const button of document.querySelectorAll('.best')) button.hidden = app.alpha === null;
  }

  points_of(curve) {
    if (!this.drawn_curves.has(curve)) {
      const points = curve.history.map(({ alpha, error }) => ({ x: alpha, y: error / curve.length, alpha }));
      this.drawn_curves.set(curve, { points, dips: minima(points) });
    }
    return this.drawn_curves.get(curve);
  }

  // The best throw ends the curve: more force is in vain. Between the gains of the curve it may lie in
  // a narrow valley.
  pareto_of(curve, best_throw) {
    const point = ({ alpha, error, control_effort }) => ({ x: control_effort, y: (error.mean ?? error) / curve.length, alpha });
    const points = curve.points.map(point);
    if (best_throw?.key !== curve.key) return { points, best: null };
    const best = point(best_throw.flight);
    return { points: [...points.filter(({ x, y }) => x < best.x && y > best.y), best], best };
  }

  draw_gain(colors) {
    const { native } = app.results;
    const shown = engines().filter((engine) => app.results[engine]?.curve
      && (engine === 'native' || (shows(engine) && app.own_gain && !app.results[engine].stale)));
    this.gain.curves = shown.map((engine) => {
      const { curve, key, best } = app.results[engine];
      const { points, dips } = this.points_of(curve);
      return {
        points, marks: dips.filter(({ x }) => x > 0), best: points.find(({ alpha }) => alpha === best) ?? null,
        color: engine === 'native' ? colors.a : colors.b, faint: curve.key !== key,
      };
    });
    const own = app.engine === 'box2d' && app.own_gain ? app.results[other_engine()]?.flight?.alpha : native?.best;
    const alpha = app.alpha ?? own ?? null;
    this.gain.cursor = alpha === null ? null : { x: alpha };
    this.gain.draw(colors);
    const slider = $('gain-chart');
    slider.setAttribute('aria-valuemin', 0);
    slider.setAttribute('aria-valuemax', this.gain.range[1]);
    slider.setAttribute('aria-valuenow', alpha ?? 0);
    slider.setAttribute('aria-valuetext', `${digits(alpha ?? 0)} newton per metre`);
    if (!native?.curve) return;
    const { points, dips } = this.points_of(native.curve);
    const launch_only = points.find(({ x }) => x === 0);
    $('gain-note').textContent =
      (app.alpha === null ? 'Drag along the curve to try another α. ' : `Trying α = ${digits(app.alpha, 4)} N/m; best ${digits(native.best, 4)}. `) +
      (dips.length > 1 ? `${dips.length} minima.` : 'One minimum.') +
      (launch_only ? ` Without control ${digits(100 * launch_only.y)} %.` : '');
  }

  draw_pareto(colors) {
    const { native } = app.results;
    const curve = native?.pareto_front;
    $('pareto-unit').textContent = effort_unit();
    this.pareto.curves = curve ? [{ ...this.pareto_of(curve, native.best_throw), marks: [], color: colors.a, faint: curve.key !== native.key }] : [];
    const flight = native?.flight;
    this.pareto.cursor = flight ? { x: flight.control_effort, y: flight.error.relative, alpha: app.alpha ?? flight.alpha } : null;
    this.pareto.draw(colors);
    if (!curve || !flight) return;
    const { first, last } = this.pareto;
    const percent = ({ y }) => `${digits(100 * y)} %`;
    $('pareto-note').textContent = first === last
      ? 'No control does better than none.'
      : `From ${percent(first)} without force to ${percent(last)} at ${digits(last.x)} ${effort_unit()}.`;
    const slider = $('pareto-chart');
    slider.setAttribute('aria-valuemin', 0);
    slider.setAttribute('aria-valuemax', last.x);
    slider.setAttribute('aria-valuenow', flight.control_effort);
    slider.setAttribute('aria-valuetext', `${digits(100 * flight.error.relative)} percent off at an effort of ${digits(flight.control_effort)} ${effort_unit()}`);
  }
}
