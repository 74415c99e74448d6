// The numbers and choices of a scene beside its shapes.

import { is_sheet, scene } from './state.js';

const $ = (id) => document.getElementById(id);

const of_chain = () => !is_sheet(), of_sheet = () => is_sheet();

// The controls that have a name of their own; a scene may have neither.
const controls = {
  best: { reference: 'morph', damping_ratio: 0.7 },
  paper: { reference: 'hold', damping_ratio: 0 },
};

// A slider's travel: logarithmic where values span decades; `zero` adds 0 at its left end.
const fields = {
  'throw-sliders': [
    { path: 'arrival_time', label: 'Arrival time t₀', unit: 's', low: 0.2, high: 4, log: true },
    { path: 'gravity', label: 'Gravity', unit: 'm/s²', low: 0, high: 20, step: 0.1 },
    { path: 'particles', label: 'Particles', unit: '', low: 3, high: 128, step: 1, when: of_chain },
    {
      path: 'control', label: 'Control', words: { best: 'follows a motion (best)', paper: 'the paper’s own', other: 'set below' },
      read: (s) => Object.keys(controls).find((name) => Object.entries(controls[name]).every(([key, value]) => s[key] === value)) ?? 'other',
      write: (s, name) => Object.assign(s, controls[name]),
    },
  ],
  'cloth-sliders': [
    { path: 'cloth.mass', label: 'Mass', unit: 'kg', low: 0.01, high: 2, log: true, when: of_chain },
    { path: 'cloth.air_drag', label: 'Air drag', unit: 'kg/s', low: 0.001, high: 1, log: true, zero: true, when: of_chain },
    { path: 'cloth.stretch_stiffness', label: 'Stretch stiffness', unit: 'N', low: 5, high: 5000, log: true, when: of_chain },
    { path: 'cloth.stretch_damping', label: 'Stretch damping', unit: 'N·s', low: 1e-5, high: 0.1, log: true, zero: true, when: of_chain },
    { path: 'cloth.hinge_stiffness', label: 'Hinge stiffness', unit: 'N·m²', low: 1e-5, high: 0.1, log: true, zero: true, when: of_chain },
    { path: 'cloth.hinge_damping', label: 'Hinge damping', unit: 'N·m²·s', low: 1e-6, high: 1e-3, log: true, zero: true, when: of_chain },
    { path: 'cloth.areal_density', label: 'Weight per area', unit: 'kg/m²', low: 0.02, high: 2, log: true, when: of_sheet },
    { path: 'cloth.air_drag', label: 'Air drag', unit: 'kg/(s·m²)', low: 0.001, high: 1, log: true, zero: true, when: of_sheet },
    { path: 'cloth.stretch_stiffness', label: 'Stretch stiffness', unit: 'N/m', low: 20, high: 5000, log: true, when: of_sheet },
    { path: 'cloth.stretch_damping', label: 'Stretch damping', unit: 'N·s/m', low: 1e-4, high: 0.1, log: true, zero: true, when: of_sheet },
    { path: 'cloth.shear_stiffness', label: 'Shear stiffness', unit: 'N/m', low: 1, high: 2000, log: true, zero: true, when: of_sheet },
    { path: 'cloth.bending_stiffness', label: 'Bending stiffness', unit: 'N·m', low: 1e-6, high: 1e-2, log: true, zero: true, when: of_sheet },
    { path: 'cloth.bending_damping', label: 'Bending damping', unit: 'N·m·s', low: 1e-7, high: 1e-4, log: true, zero: true, when: of_sheet },
  ],
  'control-fields': [
    { path: 'reference', label: 'Pulls towards', words: { hold: 'the target, from the start (hold)', morph: 'a motion to it (morph)' } },
    { path: 'arrival', label: 'Motion arrives', words: { pass: 'in full swing', settle: 'at rest' }, when: (s) => s.reference === 'morph' },
    { path: 'damping_ratio', label: 'Damping ratio ζ', unit: '', low: 0, high: 2, step: 0.01 },
    { path: 'launch', label: 'Launch', words: { ballistic: 'ballistic', inextensible: 'inextensible' } },
    { path: 'rest', label: 'Unbent shape', words: { initial: 'the start', flat: 'flat' }, when: of_sheet },
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

const read = (field) => (field.read ? field.read(scene()) : read_field(field.path));
const write = (field, value) => (field.write ? field.write(scene(), value) : write_field(field.path, value));

// `changed(live)` is called when one of them has changed.
export function make_fields(changed) {
  for (const [id, list] of Object.entries(fields)) {
    for (const field of list) {
      const row = document.createElement('div');
      row.className = 'field';
      const name = `field-${field.path.replace('.', '-')}${field.when === of_sheet ? '-sheet' : ''}`;
      if (field.words) {
        row.innerHTML = `<label for="${name}">${field.label}</label><select id="${name}">${
          Object.entries(field.words).map(([value, text]) => `<option value="${value}">${text}</option>`).join('')}</select>`;
        row.querySelector('select').addEventListener('change', (event) => {
          write(field, event.target.value);
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
          changed(true);
        });
        range.addEventListener('change', () => changed(false));
      }
      field.row = row;
      $(id).append(row);
    }
  }
}

export function update_fields() {
  for (const list of Object.values(fields)) {
    for (const field of list) {
      field.row.hidden = field.when ? !field.when(scene()) : false;
      if (field.row.hidden) continue;
      const value = read(field);
      if (field.words) field.row.querySelector('select').value = value;
      else {
        const [number, range] = field.row.querySelectorAll('input');
        number.value = value;
        // A travel that means this value stays: between two whole numbers there are several.
        if (from_travel(field, Number(range.value)) !== value) range.value = to_travel(field, value);
        range.setAttribute('aria-valuetext', `${value} ${field.unit}`);
      }
    }
  }
}
