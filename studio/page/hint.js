// What the page says to newcomers, and of the shape in hand.

import * as geometry from './geometry.js';
import { digits } from './numbers.js';
import { app, is_sheet, scene } from './state.js';

const $ = (id) => document.getElementById(id);

const flies_on = () => app.time !== null && app.time > scene().arrival_time * 1.0001;
const flying_on = 'After arrival nothing controls the cloth: it flies on.';

function sheet_hint(trouble) {
  if (trouble) return trouble;
  if (flies_on()) return flying_on;
  if (app.tool === 'pan') return 'Drag to turn the view, scroll or pinch to zoom, drag with the right button to pan.';
  const verb = { move: 'Move', turn: 'Turn', scale: 'Scale' }[app.tool];
  return `${verb} the target by its handle: the best throw follows. Drag beside it to turn the view.`;
}

function chain_hint(stroke) {
  const { initial, target, target_length } = scene();
  const cloth = geometry.length(initial), drawn = geometry.length(target);
  if (stroke) {
    const far = geometry.length(stroke);
    return app.selected === 'target' ? `${digits(far)} m drawn; the cloth is ${digits(cloth)} m` : `${digits(far)} m of cloth`;
  }
  if (flies_on()) return flying_on;
  if (app.tool === 'draw') return `Draw the ${app.selected} shape in one stroke.`;
  if (Math.abs(drawn / cloth - 1) >= 0.004) {
    return target_length === 'fit'
      ? `The target is drawn ${digits(drawn)} m long, the cloth is ${digits(cloth)} m: it is scaled by ${digits(cloth / drawn)} (dotted: as drawn).`
      : `The target is ${digits(drawn)} m long and left as drawn, the cloth is ${digits(cloth)} m: it cannot cover it exactly.`;
  }
  if (app.tool === 'points') return 'Drag a point; its neighbours follow. With Shift it moves alone.';
  if (app.tool === 'pan') return 'Drag to pan, scroll or pinch to zoom.';
  return `Drag the ${app.selected}: the best throw follows.`;
}

// `trouble`: of the view in space, empty where there is none; `stroke`: what is being drawn, or null.
export function show_hint(trouble, stroke) {
  const text = is_sheet() ? sheet_hint(trouble) : chain_hint(stroke);
  if ($('hint').textContent !== text) $('hint').textContent = text;
}

// Three steps, until they are put away.
export function welcome_newcomers() {
  const key = 'nuno-studio-known';
  try {
    $('first').hidden = localStorage.getItem(key) !== null;
  } catch {
    return; // it could not be put away for good
  }
  $('first-done').addEventListener('click', () => {
    $('first').hidden = true;
    try { localStorage.setItem(key, '1'); } catch { /* it comes again */ }
  });
}
