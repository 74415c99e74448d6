// A sheet on the report's stage: shaded faces, the far ones first, over its soft shadow. The same
// light and colors as in the figures, see sheet_shading.cpp.

const sheetLight = (() => {
  const [x, y, z] = [0.35, 0.85, 0.45];
  const size = Math.hypot(x, y, z);
  return [x / size, y / size, z / size];
})();
const sheetColors = {
  a: [[0, 118, 182], [84, 162, 206]],
  b: [[222, 112, 20], [232, 156, 92]],
  target: [[176, 180, 188], [196, 199, 206]],
  soft: [[140, 144, 154], [164, 168, 176]],
};
const shadowSlant = 0.12; // over the height of what throws it
const shadowRim = 5; // pixels, as far as copies of it are apart

class SheetPainter {
  /// `canvas` lies under the drawing; `seen(flat)` and `plot` put a pose on it.
  constructor(canvas, faces, ground) {
    Object.assign(this, { canvas, faces, ground });
    this.shade = document.createElement('canvas');
    this.border = this.borderOf(faces);
  }

  /// The edges of one face only, two particles each.
  borderOf(faces) {
    const edges = new Map();
    for (const face of faces) {
      face.forEach((a, k) => {
        const edge = [a, face[(k + 1) % face.length]];
        const key = [...edge].sort((x, y) => x - y).join();
        if (!edges.delete(key)) edges.set(key, edge);
      });
    }
    return this.joined([...edges.values()]);
  }

  /// Edges as lines, each from where the one before it ends.
  joined(edges) {
    const next = new Map(edges);
    const lines = [];
    while (next.size > 0) {
      let [at] = next.keys();
      const line = [at];
      while (next.has(at)) {
        const to = next.get(at);
        next.delete(at);
        line.push(at = to);
      }
      lines.push(line);
    }
    return lines;
  }

  resize(width, height) {
    const ratio = window.devicePixelRatio || 1;
    for (const canvas of [this.canvas, this.shade]) {
      [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
      canvas.getContext('2d').setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${height}px`;
    [this.width, this.height] = [width, height];
  }

  /// poses: [{flat: x, y, z of each particle, color, opacity, shadow, outlined: its border is drawn
  /// upon all}], from back to front;
  /// ring: the place of one around what is to be looked at, or null.
  paint(poses, view, ring = null) {
    const context = this.canvas.getContext('2d');
    context.clearRect(0, 0, this.width, this.height);
    for (const pose of poses) if (pose.shadow) this.shadow(context, pose.flat, view);
    for (const pose of poses) this.cloth(context, pose, view);
    for (const pose of poses) if (pose.outlined) this.outline(context, pose, view);
    if (!ring) return;
    context.strokeStyle = getComputedStyle(this.canvas).color;
    context.lineWidth = 1.5;
    context.beginPath();
    context.arc(...ring, 11, 0, 2 * Math.PI);
    context.stroke();
  }

  /// Places on the canvas, x and y of each particle.
  placed(flat, { seen, plot }) {
    const places = seen(flat).slice();
    for (let i = 0; i < places.length; i += 2) {
      places[i] = plot.x(places[i]);
      places[i + 1] = plot.y(places[i + 1]);
    }
    return places;
  }

  trace(context, face, places) {
    face.forEach((i, k) => (k ? context.lineTo(places[2 * i], places[2 * i + 1]) : context.moveTo(places[2 * i], places[2 * i + 1])));
    context.closePath();
  }

  outline(context, { flat, color }, view) {
    const places = this.placed(flat, view);
    context.strokeStyle = `rgb(${sheetColors[color][0].join(' ')})`;
    context.lineWidth = 2;
    context.setLineDash([7, 4]);
    for (const line of this.border) {
      context.beginPath();
      for (const i of line) context.lineTo(places[2 * i], places[2 * i + 1]);
      context.stroke();
    }
    context.setLineDash([]);
  }

  shadow(context, flat, view) {
    const low = flat.slice();
    for (let i = 0; i < flat.length; i += 3) {
      const height = flat[i + 1] - this.ground;
      low[i] -= shadowSlant * height;
      low[i + 1] = this.ground;
      low[i + 2] -= shadowSlant * height;
    }
    const places = this.placed(low, view);
    const shade = this.shade.getContext('2d');
    shade.clearRect(0, 0, this.width, this.height);
    shade.fillStyle = shade.strokeStyle = '#000';
    for (const face of this.faces) {
      shade.beginPath();
      this.trace(shade, face, places);
      shade.fill();
      shade.stroke(); // against gaps
    }
    // Soft: copies of it about its place.
    context.globalAlpha = 0.022;
    for (let k = 0; k < 12; ++k) {
      const [turn, far] = [2.4 * k, shadowRim * Math.sqrt((k + 0.5) / 12)];
      context.drawImage(this.shade, far * Math.cos(turn), 0.6 * far * Math.sin(turn), this.width, this.height);
    }
    context.globalAlpha = 1;
  }

  cloth(context, { flat, color, opacity }, view) {
    const places = this.placed(flat, view);
    const { eye } = view;
    const over = this.shade.getContext('2d'); // opaque there, as a whole translucent here
    over.clearRect(0, 0, this.width, this.height);
    const near = this.faces.map((face) => {
      let sum = 0;
      for (const i of face) sum += eye[0] * flat[3 * i] + eye[1] * flat[3 * i + 1] + eye[2] * flat[3 * i + 2];
      return sum / face.length;
    });
    const order = near.map((_, f) => f).sort((f, g) => near[f] - near[g]);
    over.lineWidth = 0.7;
    over.lineJoin = 'round';
    for (const f of order) {
      const normal = this.normal(this.faces[f], flat);
      const dot = (v) => normal[0] * v[0] + normal[1] * v[1] + normal[2] * v[2];
      const lit = 0.62 + 0.5 * Math.abs(dot(sheetLight));
      const base = sheetColors[color][dot(eye) >= 0 ? 0 : 1];
      over.fillStyle = over.strokeStyle = `rgb(${base.map((x) => Math.min(255, Math.round(lit * x))).join(' ')})`;
      over.beginPath();
      this.trace(over, this.faces[f], places);
      over.fill();
      over.stroke(); // against gaps
    }
    context.globalAlpha = opacity;
    context.drawImage(this.shade, 0, 0, this.width, this.height);
    context.globalAlpha = 1;
  }

  normal(face, flat) {
    const sum = [0, 0, 0];
    const at = (i, k) => flat[3 * i + k];
    for (let k = 2; k < face.length; ++k) {
      const [o, p, q] = [face[0], face[k - 1], face[k]];
      const a = [0, 1, 2].map((n) => at(p, n) - at(o, n)), b = [0, 1, 2].map((n) => at(q, n) - at(o, n));
      sum[0] += a[1] * b[2] - a[2] * b[1];
      sum[1] += a[2] * b[0] - a[0] * b[2];
      sum[2] += a[0] * b[1] - a[1] * b[0];
    }
    const size = Math.hypot(...sum) || 1;
    return sum.map((x) => x / size);
  }
}
