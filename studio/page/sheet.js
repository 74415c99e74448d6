// Sheets: scenes whose shapes are meshes in space, {vertices: [[x, y, z]…], faces}.

import { digits } from './numbers.js';
import { app, scene } from './state.js';

const short = (x) => Number(x.toPrecision(7));

export const rounded_points = (points) => points.map((point) => point.map(short));

export function middle(points) {
  const sum = [0, 0, 0];
  for (const point of points) for (let k = 0; k < 3; k++) sum[k] += point[k];
  return sum.map((x) => x / points.length);
}

// `elements` of a 4 × 4 matrix, a column after another.
export const transformed = (points, e) =>
  points.map(([x, y, z]) => [0, 1, 2].map((k) => e[k] * x + e[k + 4] * y + e[k + 8] * z + e[k + 12]));

export const shifted = (points, by) => points.map((point) => point.map((x, k) => x + by[k]));

export function scaled(points, factor) {
  const at = middle(points);
  return points.map((point) => point.map((x, k) => at[k] + factor * (x - at[k])));
}

// About the upright axis through the middle.
export function turned(points, angle) {
  const [cx, , cz] = middle(points), c = Math.cos(angle), s = Math.sin(angle);
  return points.map(([x, y, z]) => [cx + c * (x - cx) + s * (z - cz), y, cz - s * (x - cx) + c * (z - cz)]);
}

export const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

const keys = {
  ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0], PageUp: [0, 0, -1], PageDown: [0, 0, 1],
};

// What a key does to the target; null where it does nothing.
export function keyed(points, event, length) {
  const far = event.shiftKey ? 5 : 1;
  if (keys[event.key]) return shifted(points, keys[event.key].map((x) => (x * far * length) / 50));
  if (event.key === '[' || event.key === ']') return turned(points, ((event.key === '[' ? 1 : -1) * Math.PI) / 36);
  if (event.key === '<' || event.key === '>') return scaled(points, event.key === '<' ? 1 / 1.02 : 1.02);
  return null;
}

// From the color of the cloth to that of what is wrong, by an error over the largest.
export function error_colors(shape, target, largest, good, bad) {
  return shape.map((point, i) => {
    const share = largest > 0 ? Math.min(1, distance(point, target[i]) / largest) : 0;
    return good.map((x, k) => x + share * (bad[k] - x));
  });
}

// '#rrggbb' as three shares.
export const shares_of = (color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16) / 255);
export const mixed = (color, other, share) => {
  const [a, b] = [shares_of(color), shares_of(other)];
  return `#${a.map((x, k) => Math.round(255 * (x + share * (b[k] - x))).toString(16).padStart(2, '0')).join('')}`;
};

export function swap_poses() {
  const { initial, target } = scene();
  app.doc.scene = { ...scene(), initial: { ...initial, vertices: target.vertices }, target: { vertices: initial.vertices } };
}

// Where it passes through itself and the ground, in words; empty where it does not, or nobody looked.
export function crossing_words(crossings, length) {
  if (!crossings?.frames) return '';
  const percent = (depth) => `${digits((100 * depth) / length, 2)} %`;
  const parts = [];
  if (crossings.crossed_frames > 0) {
    parts.push(`Passes through itself in ${crossings.crossed_frames} of ${crossings.frames} frames, first at ${crossings.first_time.toFixed(2)} s, ${percent(crossings.depth)} of its size deep.`);
  }
  if (crossings.grounded_frames > 0) {
    parts.push(`Reaches ${percent(crossings.ground_depth)} of its size below the ground, first at ${crossings.ground_time.toFixed(2)} s.`);
  }
  return parts.join(' ');
}
