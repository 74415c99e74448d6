// Shapes: arrays of points [x, y] in metres, y up.

export const length = (line) =>
  line.reduce((sum, p, i) => sum + (i ? Math.hypot(p[0] - line[i - 1][0], p[1] - line[i - 1][1]) : 0), 0);

// Of the drawn line, not of its vertices: it stays where it is when vertices are added.
export function centroid(line) {
  let x = 0, y = 0, sum = 0;
  for (let i = 1; i < line.length; i++) {
    const w = Math.hypot(line[i][0] - line[i - 1][0], line[i][1] - line[i - 1][1]);
    x += (w * (line[i][0] + line[i - 1][0])) / 2;
    y += (w * (line[i][1] + line[i - 1][1])) / 2;
    sum += w;
  }
  return sum > 0 ? [x / sum, y / sum] : [...line[0]];
}

export function mean(points) {
  let x = 0, y = 0;
  for (const p of points) { x += p[0]; y += p[1]; }
  return [x / points.length, y / points.length];
}

export function bounds(...lines) {
  const box = { left: Infinity, right: -Infinity, bottom: Infinity, top: -Infinity };
  for (const line of lines) {
    for (const [x, y] of line) {
      box.left = Math.min(box.left, x);
      box.right = Math.max(box.right, x);
      box.bottom = Math.min(box.bottom, y);
      box.top = Math.max(box.top, y);
    }
  }
  return box;
}

// Seven digits: a hair's width in a hall, and short files.
const short = (x) => Number(x.toPrecision(7));
export const rounded = (line) => line.map(([x, y]) => [short(x), short(y)]);

export const moved = (line, dx, dy) => line.map(([x, y]) => [x + dx, y + dy]);

export const scaled = (line, factor, about = centroid(line)) =>
  line.map(([x, y]) => [about[0] + factor * (x - about[0]), about[1] + factor * (y - about[1])]);

export function rotated(line, angle, about = centroid(line)) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return line.map(([x, y]) => {
    const dx = x - about[0], dy = y - about[1];
    return [about[0] + c * dx - s * dy, about[1] + s * dx + c * dy];
  });
}

export const reversed = (line) => [...line].reverse();

export function flipped(line, axis) {
  const [cx, cy] = centroid(line);
  return line.map(([x, y]) => (axis === 'x' ? [2 * cx - x, y] : [x, 2 * cy - y]));
}

export function resampled(line, count) {
  const total = length(line);
  const result = [[...line[0]]];
  let done = 0, i = 1;
  for (let k = 1; k < count - 1; k++) {
    const wanted = (total * k) / (count - 1);
    for (;;) {
      const a = line[i - 1], b = line[i];
      const step = Math.hypot(b[0] - a[0], b[1] - a[1]);
      if (done + step >= wanted || i === line.length - 1) {
        const t = step > 0 ? (wanted - done) / step : 0;
        result.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        break;
      }
      done += step;
      i++;
    }
  }
  result.push([...line[line.length - 1]]);
  return result;
}

const stroke_points = 64;

// What a hand meant: the stroke without its jitter, at equal distances.
export function stroke(points) {
  const distinct = points.filter((p, i) => !i || Math.hypot(p[0] - points[i - 1][0], p[1] - points[i - 1][1]) > 0);
  if (distinct.length < 2) return null;
  let line = resampled(distinct, stroke_points);
  for (let pass = 0; pass < 2; pass++) {
    line = line.map((p, i) => {
      if (i === 0 || i === line.length - 1) return p;
      return [0, 1].map((k) => 0.25 * line[i - 1][k] + 0.5 * p[k] + 0.25 * line[i + 1][k]);
    });
  }
  return resampled(line, stroke_points);
}

// The vertex `index` moved; on a fine line its neighbours come along.
export function vertex_moved(line, index, dx, dy, alone) {
  const reach = alone || line.length <= 24 ? 0 : Math.max(2, Math.round(0.1 * line.length));
  return line.map(([x, y], i) => {
    const far = Math.abs(i - index);
    const share = far === 0 ? 1 : far <= reach ? 0.5 + 0.5 * Math.cos((Math.PI * far) / (reach + 1)) : 0;
    return [x + share * dx, y + share * dy];
  });
}

export function distance_to_line(line, [px, py]) {
  let best = Infinity;
  for (let i = 1; i < line.length; i++) {
    const [ax, ay] = line[i - 1], [bx, by] = line[i];
    const dx = bx - ax, dy = by - ay, square = dx * dx + dy * dy;
    const t = square > 0 ? Math.max(0, Math.min(1, ((px - ax) * dx + (py - ay) * dy) / square)) : 0;
    best = Math.min(best, Math.hypot(px - ax - t * dx, py - ay - t * dy));
  }
  return best;
}

export function nearest_vertex(line, [px, py]) {
  let best = 0, least = Infinity;
  line.forEach(([x, y], i) => {
    const d = Math.hypot(x - px, y - py);
    if (d < least) [best, least] = [i, d];
  });
  return best;
}

const curve = (count, f) => Array.from({ length: count }, (_, i) => f(i / (count - 1)));
const arc = (cx, cy, rx, ry, from, to, count = 24) =>
  curve(count, (t) => {
    const a = ((from + t * (to - from)) * Math.PI) / 180;
    return [cx + rx * Math.cos(a), cy + ry * Math.sin(a)];
  });

const letters = {
  C: arc(0.5, 0.5, 0.45, 0.5, 50, 310, 40),
  J: [[0.75, 1], [0.75, 0.3], ...arc(0.42, 0.3, 0.33, 0.3, -15, -165, 16)],
  L: [[0, 1], [0, 0], [0.6, 0]],
  M: [[0, 0], [0.1, 1], [0.5, 0.3], [0.9, 1], [1, 0]],
  N: [[0, 0], [0, 1], [0.75, 0], [0.75, 1]],
  U: [[0, 1], [0, 0.4], ...arc(0.4, 0.4, 0.4, 0.4, 190, 350, 20), [0.8, 0.4], [0.8, 1]],
  V: [[0, 1], [0.4, 0], [0.8, 1]],
  W: [[0, 1], [0.25, 0], [0.5, 0.75], [0.75, 0], [1, 1]],
  Z: [[0, 1], [0.75, 1], [0, 0], [0.75, 0]],
};

export const presets = {
  line: { label: 'Line', line: [[0, 0], [1, 0]] },
  arch: { label: 'Arch', line: arc(0, 0, 0.5, 0.5, 180, 0, 33) },
  s: {
    label: 'S',
    line: [...arc(0.3, 0.7, 0.3, 0.3, 60, 270, 24), ...arc(0.3, 0.1, 0.3, 0.3, 90, -120, 24).slice(1)],
  },
  wave: { label: 'Wave', line: curve(49, (t) => [t, 0.13 * Math.sin(4 * Math.PI * t)]) },
  spiral: {
    label: 'Spiral',
    line: curve(65, (t) => {
      const a = 4 * Math.PI * t, r = 0.12 + 0.38 * t;
      return [r * Math.cos(a), r * Math.sin(a)];
    }),
  },
  ...Object.fromEntries(
    Object.entries(letters).map(([letter, line]) => [`letter-${letter}`, { label: `Letter ${letter}`, line }])),
};

// A preset with the centroid and the length asked for.
export function preset(name, about, wanted) {
  const line = presets[name].line;
  const [cx, cy] = centroid(line);
  return moved(scaled(line, wanted / length(line)), about[0] - cx, about[1] - cy);
}
