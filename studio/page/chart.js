// Error over something, both logarithmic: a curve, its marks, and a gain that is picked by a click, a
// drag or the arrow keys.

const margin = { left: 50, right: 10, top: 12, bottom: 26 };
const zero_width = 22; // 0 has no place on a logarithmic axis: it has its own, at the left
const snap = 5; // pixels
const most_decades = 4; // of error, downwards from the largest

export class Chart {
  // `picks` says what can be picked: 'values' (the axis is the gain itself) or 'points' of the first
  // curve.
  // `on_try(α, live)`: a gain to be tried; α null is the best one again.
  constructor(canvas, picks, on_try) {
    Object.assign(this, { canvas, picks, on_try });
    // {points: [{x, y, alpha}] along x, marks: those that stand out, best: one of them or null,
    //  color, faint}; y is a share.
    this.curves = [];
    this.cursor = null; // {x, y, alpha}: the throw that is shown; without y, a line
    this.range = [1e-3, 1e3];
    canvas.addEventListener('pointerdown', (event) => {
      if (!this.curves.length) return;
      canvas.setPointerCapture(event.pointerId);
      this.dragging = true;
      canvas.focus({ preventScroll: true });
      this.try_at(event, true);
    });
    canvas.addEventListener('pointermove', (event) => this.dragging && this.try_at(event, true));
    canvas.addEventListener('pointerup', (event) => {
      if (!this.dragging) return;
      this.dragging = false;
      this.try_at(event, false);
    });
    canvas.addEventListener('pointercancel', () => (this.dragging = false));
    canvas.addEventListener('dblclick', () => this.on_try(null, false));
    canvas.addEventListener('keydown', (event) => this.key(event));
  }

  key(event) {
    if (!this.curves.length) return;
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key] ?? 0;
    let next;
    if (event.key === 'Enter' || event.key === 'Escape') next = null;
    else if (event.key === 'Home') next = this.first.alpha;
    else if (event.key === 'End') next = this.last.alpha;
    else if (step) next = this.picks === 'points' ? this.neighbour(step * (event.shiftKey ? 5 : 1)) : this.along(step * (event.shiftKey ? 8 : 1));
    else return;
    event.preventDefault();
    event.stopPropagation();
    this.on_try(next, false);
  }

  get points() { return this.curves[0].points; }
  get first() { return this.points[0]; }
  get last() { return this.points.at(-1); }

  // A 64th of a decade further.
  along(steps) {
    const [low, high] = this.range;
    const now = this.cursor?.x ?? low;
    const next = Math.min(high, Math.max(low, now) * 10 ** (steps / 64));
    if (steps < 0) return now <= low ? 0 : Math.max(low, next);
    return now < low ? low : next;
  }

  // The next point that way, seen from a cursor that need not be on one.
  neighbour(steps) {
    const { points } = this;
    const now = this.cursor?.x ?? this.first.x;
    const here = points.findIndex(({ alpha }) => alpha === this.cursor?.alpha);
    const above = points.findIndex(({ x }) => x > now);
    const between = (above < 0 ? points.length : above) - 0.5;
    const index = here >= 0 ? here + steps : steps > 0 ? Math.floor(between + steps) : Math.ceil(between + steps);
    return points[Math.max(0, Math.min(points.length - 1, index))].alpha;
  }

  try_at(event, live) {
    const at = event.clientX - this.canvas.getBoundingClientRect().left;
    const distance = ({ x }) => Math.abs(this.x(x) - at);
    const nearest = (points) => points.reduce((a, b) => (distance(b) < distance(a) ? b : a));
    if (this.picks === 'points') return this.on_try(nearest(this.points).alpha, live);
    const marks = this.curves.flatMap(({ marks, best }) => (best ? [best, ...marks] : marks)).filter(({ x }) => x > 0);
    const mark = marks.length ? nearest(marks) : null;
    this.on_try(mark && distance(mark) < snap ? mark.alpha : this.value_at(at), live);
  }

  get plot() {
    return { left: margin.left + zero_width, right: this.width - margin.right, top: margin.top, bottom: this.height - margin.bottom };
  }
  x(value) {
    const { left, right } = this.plot;
    if (!(value > 0)) return margin.left + 4;
    const [low, high] = this.range;
    const share = Math.log(value / low) / Math.log(high / low);
    return left + Math.max(0, Math.min(1, share)) * (right - left);
  }
  value_at(x) {
    const { left, right } = this.plot;
    if (x < left - zero_width / 2) return 0;
    const [low, high] = this.range;
    const share = Math.max(0, Math.min(1, (x - left) / (right - left)));
    return Number((low * (high / low) ** share).toPrecision(6));
  }
  y(share) {
    const { top, bottom } = this.plot;
    const [low, high] = this.heights;
    const t = Math.log(Math.max(share, low) / low) / Math.log(high / low);
    return bottom - Math.min(1.02, t) * (bottom - top);
  }

  // Says whether there is anything to draw.
  measure() {
    if (!this.curves.length) return false;
    const points = this.curves.flatMap((curve) => curve.points);
    // The cursor may lie beyond the curve; a throw that is corrected off, as deep below it as rounding.
    const along = [...points, ...(this.cursor ? [this.cursor] : [])].map(({ x }) => x).filter((x) => x > 0);
    const shares = points.map(({ y }) => y).filter((y) => y > 0);
    if (!along.length || !shares.length) return false;
    this.range = [Math.min(...along), Math.max(...along)];
    if (this.range[1] / this.range[0] < 1.01) this.range = [this.range[0] / 2, 2 * this.range[0]];
    const high = Math.max(...shares) * 1.3;
    const low = Math.max(Math.min(...shares) / 1.5, high / 10 ** most_decades);
    this.heights = high / low < 4 ? [low / 1.5, high * 1.5] : [low, high];
    return true;
  }

  draw(colors) {
    const ratio = devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    const w = Math.round(this.width * ratio), h = Math.round(this.height * ratio);
    if (this.canvas.width !== w || this.canvas.height !== h) [this.canvas.width, this.canvas.height] = [w, h];
    const ctx = this.canvas.getContext('2d');
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, this.width, this.height);
    ctx.font = '11px system-ui, sans-serif';
    if (!this.measure()) return;
    this.axes(ctx, colors);
    for (const curve of this.curves) this.curve(ctx, curve, colors);
    if (this.cursor) this.draw_cursor(ctx, colors);
  }

  // 1, 2, 5 upwards while there is room; decades along, finer where there are few.
  axes(ctx, colors) {
    const { right, top, bottom } = this.plot;
    const line = (x0, y0, x1, y1) => {
      ctx.strokeStyle = colors.grid;
      ctx.beginPath();
      ctx.moveTo(x0, y0);
      ctx.lineTo(x1, y1);
      ctx.stroke();
    };
    const rounds = ([low, high], ones) => {
      const values = [];
      for (let decade = Math.floor(Math.log10(low)); decade <= Math.log10(high); decade++) {
        for (const digit of ones) values.push(Number(`${digit}e${decade}`));
      }
      return values.filter((value) => value >= low && value <= high);
    };
    const name = (value) => (value >= 1e-3 && value < 1e4 ? String(value) : value.toExponential(0).replace('+', '').replace('-', '−'));
    ctx.lineWidth = 1;
    ctx.fillStyle = colors.quiet;
    ctx.textBaseline = 'middle';
    ctx.textAlign = 'right';
    let last = Infinity;
    for (const share of rounds(this.heights, [1, 2, 5])) {
      if (last - this.y(share) < 17) continue;
      last = this.y(share);
      line(margin.left, Math.round(last) + 0.5, right, Math.round(last) + 0.5);
      ctx.fillText(`${name(Number((100 * share).toPrecision(1)))} %`, margin.left - 5, last);
    }
    ctx.textAlign = 'center';
    ctx.textBaseline = 'top';
    ctx.fillText('0', this.x(0), bottom + 6);
    const few = this.range[1] / this.range[0] < 300;
    last = this.x(0) + ctx.measureText('0').width / 2;
    for (const value of rounds(this.range, few ? [1, 2, 5] : [1])) {
      const at = this.x(value);
      line(Math.round(at) + 0.5, top, Math.round(at) + 0.5, bottom);
      const wide = ctx.measureText(name(value)).width;
      if (at + wide / 2 > this.width || at - wide / 2 < last + 6) continue;
      last = at + wide / 2;
      ctx.fillText(name(value), at, bottom + 6);
    }
  }

  curve(ctx, { points, marks, best, color, faint }, colors) {
    ctx.globalAlpha = faint ? 0.35 : 1;
    ctx.strokeStyle = color;
    ctx.lineWidth = 1.75;
    ctx.lineJoin = 'round';
    ctx.beginPath();
    for (const { x, y } of points) {
      if (x > 0) ctx.lineTo(this.x(x), this.y(y));
    }
    ctx.stroke();
    for (const { x, y } of points) {
      if (x === 0) this.dot(ctx, this.x(0), this.y(y), 3, color, color);
    }
    for (const { x, y } of marks) this.dot(ctx, this.x(x), this.y(y), 3, colors.panel, color);
    if (best) this.dot(ctx, this.x(best.x), this.y(best.y), 4.5, color, colors.panel);
    ctx.globalAlpha = 1;
  }

  draw_cursor(ctx, colors) {
    const { top, bottom } = this.plot;
    const at = this.x(this.cursor.x);
    ctx.strokeStyle = colors.ink;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(at, top - 4);
    ctx.lineTo(at, bottom);
    ctx.stroke();
    ctx.fillStyle = colors.ink;
    ctx.beginPath();
    ctx.moveTo(at - 5, top - 11);
    ctx.lineTo(at + 5, top - 11);
    ctx.lineTo(at, top - 3);
    ctx.fill();
    if (this.cursor.y > 0) this.dot(ctx, at, Math.min(bottom, this.y(this.cursor.y)), 4, colors.ink, colors.panel);
  }

  dot(ctx, x, y, radius, fill, stroke) {
    ctx.beginPath();
    ctx.arc(x, y, radius, 0, 2 * Math.PI);
    ctx.fillStyle = fill;
    ctx.fill();
    ctx.strokeStyle = stroke;
    ctx.lineWidth = 1.5;
    ctx.stroke();
  }
}
