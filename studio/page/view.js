// The stage: grid, shapes, cloths in flight, forces. Draws what it is given and keeps the camera.

import { bounds } from './geometry.js';

const handle_size = 5;
const force_pixels = 34; // of an arrow as large as a particle's weight
const longest_force = 160; // pixels
const narrow = 640; // pixels: a phone

export class View {
  constructor(canvas) {
    this.canvas = canvas;
    this.camera = { x: 1.5, y: 1.2, scale: 200 }; // middle [m], pixels per metre
    this.resize(1);
  }

  // `views`: how many stand side by side or, where that is too narrow, one above the other.
  resize(views = this.views) {
    this.views = views;
    const ratio = devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    const w = Math.round(this.width * ratio), h = Math.round(this.height * ratio);
    if (this.canvas.width !== w || this.canvas.height !== h) [this.canvas.width, this.canvas.height] = [w, h];
    this.context = this.canvas.getContext('2d');
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  get narrow() { return this.width < narrow; }
  get stacked() { return this.views > 1 && this.narrow; }
  get view_width() { return this.stacked ? this.width : this.width / this.views; }
  get view_height() { return this.stacked ? this.height / this.views : this.height; }

  // Where the things below the toolbars and above the hint have their room.
  get room() {
    const { narrow } = this;
    return { left: narrow ? 60 : 84, right: narrow ? 30 : 36, top: narrow ? 84 : 92, bottom: 84 };
  }

  to_screen([x, y]) {
    return [this.view_width / 2 + (x - this.camera.x) * this.camera.scale,
            this.view_height / 2 - (y - this.camera.y) * this.camera.scale];
  }
  // The view at a place of the canvas; one beyond the edge counts to the view beside it.
  view_at([px, py]) {
    return Math.max(0, Math.min(this.views - 1, Math.floor(this.stacked ? py / this.view_height : px / this.view_width)));
  }
  // A place of the canvas as one of a view.
  in_view(place, view = this.view_at(place)) {
    const [px, py] = place;
    return this.stacked ? [px, py - view * this.view_height] : [px - view * this.view_width, py];
  }
  to_world([x, y]) {
    return [this.camera.x + (x - this.view_width / 2) / this.camera.scale,
            this.camera.y - (y - this.view_height / 2) / this.camera.scale];
  }
  pan(dx, dy) {
    this.camera.x -= dx / this.camera.scale;
    this.camera.y += dy / this.camera.scale;
  }
  zoom(factor, place = [this.view_width / 2, this.view_height / 2]) {
    const before = this.to_world(place);
    this.camera.scale = Math.max(1e-3, Math.min(1e7, this.camera.scale * factor));
    const after = this.to_world(place);
    this.camera.x += before[0] - after[0];
    this.camera.y += before[1] - after[1];
  }
  fit(lines) {
    const box = bounds(...lines.filter((line) => line.length));
    if (!Number.isFinite(box.left)) return;
    const { left, right, top, bottom } = this.room;
    const w = Math.max(80, this.view_width - left - right), h = Math.max(80, this.view_height - top - bottom);
    const wide = Math.max(box.right - box.left, 1e-9), high = Math.max(box.top - box.bottom, 1e-9);
    this.camera.scale = Math.min(w / wide, h / high);
    this.camera.x = (box.left + box.right) / 2 + (right - left) / 2 / this.camera.scale;
    this.camera.y = (box.bottom + box.top) / 2 + (top - bottom) / 2 / this.camera.scale;
  }

  // what: {views: [{cloths: [{color, shape, ghosts, path, forces, effort_unit}]}], initial, target,
  //        fitted, selected, tool, vertex, stroke, forces}
  draw(what, colors) {
    const ctx = this.context;
    ctx.clearRect(0, 0, this.width, this.height);
    what.views.forEach((view, i) => {
      ctx.save();
      ctx.translate(this.stacked ? 0 : i * this.view_width, this.stacked ? i * this.view_height : 0);
      ctx.beginPath();
      ctx.rect(0, 0, this.view_width, this.view_height);
      ctx.clip();
      this.grid(colors);
      this.shapes(what, view, colors);
      if (this.views > 1) {
        ctx.font = '600 12px system-ui, sans-serif';
        ctx.fillStyle = view.cloths[0]?.color ?? colors.quiet;
        ctx.textAlign = 'center';
        ctx.textBaseline = 'alphabetic';
        ctx.fillText(view.title, this.view_width / 2, this.view_height - 62);
      }
      ctx.restore();
    });
    if (what.forces) {
      ctx.font = '12px system-ui, sans-serif';
      const wide = force_pixels + 8 + ctx.measureText(what.forces).width;
      const x = this.width - wide - 20, y = this.room.top + 22;
      ctx.fillStyle = colors.paper;
      ctx.fillRect(x - 8, y - 12, wide + 16, 24);
      this.arrow(x, y, force_pixels, 0, colors.force);
      ctx.textAlign = 'left';
      ctx.textBaseline = 'middle';
      ctx.fillText(what.forces, x + force_pixels + 8, y);
    }
    if (this.views > 1) {
      ctx.fillStyle = colors.line;
      if (this.stacked) ctx.fillRect(0, Math.round(this.view_height), this.width, 1);
      else ctx.fillRect(Math.round(this.view_width), 0, 1, this.height);
    }
  }

  grid(colors) {
    const ctx = this.context;
    let step = 10 ** Math.floor(Math.log10(70 / this.camera.scale));
    for (const times of [2, 5, 10]) {
      if (step * this.camera.scale >= 70) break;
      step = 10 ** Math.floor(Math.log10(70 / this.camera.scale)) * times;
    }
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const [x0, y1] = this.to_world([0, 0]);
    const x1 = x0 + this.view_width / this.camera.scale, y0 = y1 - this.view_height / this.camera.scale;
    ctx.lineWidth = 1;
    ctx.font = '10.5px system-ui, sans-serif';
    const name = (value) => (Math.abs(value) < step / 2 ? '0' : value.toFixed(digits).replace('-', '−'));
    for (let i = Math.ceil(x0 / step); i * step <= x1; i++) {
      const at = Math.round(this.to_screen([i * step, 0])[0]) + 0.5;
      ctx.strokeStyle = i === 0 ? colors.axis : colors.grid;
      ctx.beginPath();
      ctx.moveTo(at, 0);
      ctx.lineTo(at, this.view_height);
      ctx.stroke();
      ctx.fillStyle = colors.faint;
      ctx.textAlign = 'left';
      ctx.textBaseline = 'bottom';
      if (at > 30 && at < this.view_width - 34) ctx.fillText(name(i * step) + ' m', at + 3, this.view_height - 3);
    }
    for (let i = Math.ceil(y0 / step); i * step <= y1; i++) {
      const at = Math.round(this.to_screen([0, i * step])[1]) + 0.5;
      ctx.strokeStyle = i === 0 ? colors.axis : colors.grid;
      ctx.beginPath();
      ctx.moveTo(0, at);
      ctx.lineTo(this.view_width, at);
      ctx.stroke();
      ctx.fillStyle = colors.faint;
      ctx.textAlign = 'right';
      ctx.textBaseline = 'bottom';
      if (at > 100 && at < this.view_height - 30) ctx.fillText(name(i * step) + ' m', this.view_width - 4, at - 2);
    }
  }

  trace(line) {
    const ctx = this.context;
    ctx.beginPath();
    line.forEach((p, i) => {
      const [x, y] = this.to_screen(p);
      i ? ctx.lineTo(x, y) : ctx.moveTo(x, y);
    });
  }

  polyline(line, color, width, dash = [], alpha = 1) {
    const ctx = this.context;
    ctx.globalAlpha = alpha;
    ctx.strokeStyle = color;
    ctx.lineWidth = width;
    ctx.lineJoin = ctx.lineCap = 'round';
    ctx.setLineDash(dash);
    this.trace(line);
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.globalAlpha = 1;
  }

  shapes(what, view, colors) {
    const ctx = this.context;
    // Far to near: where the target is drawn, where it is thrown at, the start, the flights.
    if (what.fitted) {
      this.polyline(what.target, colors.target, 1.25, [2, 5], 0.9);
      this.polyline(what.fitted, colors.target, 9, [], 0.28);
      this.ends(what.fitted, colors.target);
    } else {
      this.polyline(what.target, colors.target, 9, [], 0.28);
      this.ends(what.target, colors.target);
    }
    this.polyline(what.initial, colors.initial, 3, [], 0.85);
    this.ends(what.initial, colors.initial);

    for (const cloth of view.cloths) {
      if (cloth.path) this.polyline(cloth.path, cloth.color, 1.25, [1, 5], 0.7);
      for (const ghost of cloth.ghosts ?? []) this.polyline(ghost, cloth.color, 1.25, [], 0.22);
    }
    for (const cloth of view.cloths) {
      if (cloth.forces) this.forces(cloth, colors);
      if (!cloth.shape) continue;
      this.polyline(cloth.shape, cloth.color, 2.5, [], cloth.stale ? 0.4 : 1);
      const gap = cloth.shape.length > 1 ? Math.hypot(...[0, 1].map((k) => cloth.shape[1][k] - cloth.shape[0][k])) * this.camera.scale : 0;
      if (gap > 5) {
        ctx.fillStyle = cloth.color;
        for (const p of cloth.shape) {
          const [x, y] = this.to_screen(p);
          ctx.beginPath();
          ctx.arc(x, y, Math.min(3, gap / 3), 0, 2 * Math.PI);
          ctx.fill();
        }
      }
    }
    this.name(what.initial, 'initial', colors.initial, what.selected === 'initial');
    this.name(what.fitted ?? what.target, 'target', colors.target, what.selected === 'target');
    if (what.stroke) this.polyline(what.stroke, colors[what.selected], 3);
    else if (what.tool === 'move') this.handles(what[what.selected], colors);
    else if (what.tool === 'points') this.vertices(what[what.selected], what.vertex, colors[what.selected], colors);
  }

  // The first point of a shape is a ring: the n-th particle goes to the n-th point.
  ends(line, color) {
    const ctx = this.context;
    const [x, y] = this.to_screen(line[0]);
    ctx.beginPath();
    ctx.arc(x, y, 4.5, 0, 2 * Math.PI);
    ctx.strokeStyle = color;
    ctx.lineWidth = 1.75;
    ctx.stroke();
  }

  name(line, text, color, selected) {
    const ctx = this.context;
    const box = bounds(line);
    const [x, y] = this.to_screen([(box.left + box.right) / 2, box.bottom]);
    ctx.font = `${selected ? 600 : 400} 12px system-ui, sans-serif`;
    ctx.textAlign = 'center';
    ctx.textBaseline = 'top';
    ctx.fillStyle = color;
    ctx.fillText(text, x, y + (selected ? 22 : 12));
  }

  frame(line) {
    const box = bounds(line);
    const [left, top] = this.to_screen([box.left, box.top]);
    const [right, bottom] = this.to_screen([box.right, box.bottom]);
    return { left: left - 14, right: right + 14, top: top - 14, bottom: bottom + 14 };
  }

  // Corners scale, the knob turns.
  handle_places(line) {
    const { left, right, top, bottom } = this.frame(line);
    const middle = (left + right) / 2;
    return {
      nw: [left, top], ne: [right, top], sw: [left, bottom], se: [right, bottom],
      turn: [middle, top - 26],
    };
  }

  handles(line, colors) {
    const ctx = this.context;
    const { left, right, top, bottom } = this.frame(line);
    ctx.strokeStyle = colors.quiet;
    ctx.lineWidth = 1;
    ctx.setLineDash([3, 3]);
    ctx.strokeRect(Math.round(left) + 0.5, Math.round(top) + 0.5, Math.round(right - left), Math.round(bottom - top));
    ctx.beginPath();
    ctx.moveTo((left + right) / 2, top);
    ctx.lineTo((left + right) / 2, top - 26);
    ctx.stroke();
    ctx.setLineDash([]);
    for (const [name, [x, y]] of Object.entries(this.handle_places(line))) {
      ctx.beginPath();
      if (name === 'turn') ctx.arc(x, y, handle_size + 0.5, 0, 2 * Math.PI);
      else ctx.rect(x - handle_size, y - handle_size, 2 * handle_size, 2 * handle_size);
      ctx.fillStyle = colors.panel;
      ctx.fill();
      ctx.strokeStyle = colors.ink;
      ctx.lineWidth = 1.25;
      ctx.stroke();
    }
  }

  vertices(line, chosen, color, colors) {
    const ctx = this.context;
    this.polyline(line, color, 1.5);
    line.forEach((p, i) => {
      const [x, y] = this.to_screen(p);
      ctx.beginPath();
      ctx.arc(x, y, i === chosen ? 6 : line.length > 40 ? 3 : 4.5, 0, 2 * Math.PI);
      ctx.fillStyle = i === chosen ? color : colors.panel;
      ctx.fill();
      ctx.strokeStyle = color;
      ctx.lineWidth = 1.5;
      ctx.stroke();
    });
  }

  forces(cloth, colors) {
    cloth.shape.forEach((p, i) => {
      const [x, y] = this.to_screen(p);
      const [fx, fy] = cloth.forces[i].map((f) => (f / cloth.effort_unit) * force_pixels);
      const size = Math.hypot(fx, fy);
      const shown = Math.min(size, longest_force) / size;
      if (size >= 2) this.arrow(x, y, shown * fx, -shown * fy, colors.force);
    });
  }

  arrow(x, y, dx, dy, color) {
    const ctx = this.context;
    const size = Math.hypot(dx, dy), ux = dx / size, uy = dy / size, head = Math.min(6, size / 2);
    const [bx, by] = [x + dx - ux * head, y + dy - uy * head];
    ctx.strokeStyle = ctx.fillStyle = color;
    ctx.lineWidth = 1.25;
    ctx.lineCap = 'butt';
    ctx.beginPath();
    ctx.moveTo(x, y);
    ctx.lineTo(bx, by);
    ctx.stroke();
    ctx.beginPath();
    ctx.moveTo(x + dx, y + dy);
    ctx.lineTo(bx - uy * head * 0.5, by + ux * head * 0.5);
    ctx.lineTo(bx + uy * head * 0.5, by - ux * head * 0.5);
    ctx.fill();
  }
}

// The shape at a time, between the frames around it; and the forces there.
export function at_time(frames, time) {
  const { times, positions, forces } = frames;
  if (!times.length) return null;
  if (time <= times[0]) return { shape: positions[0], forces: forces[0] };
  const last = times.length - 1;
  if (time >= times[last]) return { shape: positions[last], forces: forces[last] };
  let low = 0, high = last;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    times[middle] <= time ? (low = middle) : (high = middle);
  }
  const t = (time - times[low]) / (times[high] - times[low]);
  const mix = (a, b) => a.map((p, i) => p.map((x, k) => x + t * (b[i][k] - x)));
  // Forces do not mix over the arrival, where they end.
  return { shape: mix(positions[low], positions[high]), forces: t < 0.5 ? forces[low] : forces[high] };
}
