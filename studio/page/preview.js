// A small drawing of a scene: both its shapes.

const width = 168, height = 92, margin = 8;
const azimuth = 0.45, elevation = 0.4;

// A point in space from the front, a little from the side and from above.
function seen([x, y, z]) {
  const across = Math.cos(azimuth) * x - Math.sin(azimuth) * z, deep = Math.sin(azimuth) * x + Math.cos(azimuth) * z;
  return [across, Math.cos(elevation) * y - Math.sin(elevation) * deep];
}

export function preview({ initial, target }) {
  const flat = (shape) => (shape.vertices ? shape.vertices.map(seen) : shape);
  const shapes = [flat(initial), flat(target)];
  const all = shapes.flat();
  const [left, right, low, high] = [0, 1].flatMap((k) => [Math.min(...all.map((p) => p[k])), Math.max(...all.map((p) => p[k]))]);
  const scale = Math.min((width - 2 * margin) / (right - left || 1), (height - 2 * margin) / (high - low || 1));
  const at = ([x, y]) => `${(width / 2 + scale * (x - (left + right) / 2)).toFixed(1)},${(height / 2 - scale * (y - (low + high) / 2)).toFixed(1)}`;
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  svg.setAttribute('class', 'preview');
  svg.setAttribute('aria-hidden', 'true');
  shapes.forEach((shape, i) => {
    const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
    path.setAttribute('class', i ? 'target' : 'initial');
    const around = initial.faces ? initial.faces.map((face) => [...face, face[0]]) : [shape.map((_, k) => k)];
    path.setAttribute('d', around.map((line) => `M${line.map((k) => at(shape[k])).join('L')}`).join(''));
    if (initial.faces) path.classList.add('mesh');
    svg.append(path);
  });
  return svg;
}
