// E(α): the error at arrival over the gain, both logarithmic; a gain is tried by a click or a drag.

const margin = { left: 40, right: 10, top: 12, bottom: 26 };
const zero_width = 22; // α = 0 has no place on a logarithmic axis: it has its own, at the left

export function minima(history) {
  const found = [];
  for (let i = 0; i < history.length; i++) {
    const e = history[i].error;
    let left = i - 1, right = i + 1;
    while (left >= 0 && history[left].error === e) left--;
    while (right < history.length && history[right].error === e) right++;
    const falls = left < 0 || history[left].error > e;
    const rises = right >= history.length || history[right].error > e;
    if (falls && rises && left === i - 1) found.push(history[i]);
  }
  // A dip is one if the way to the next one leads over something: a refined valley is sampled to the
  // last digits, where noise has minima of its own.
  const dips = [];
  for (const m of found) {
    const last = dips[dips.length - 1];
    const between = last ? history.filter((s) => s.alpha > last.alpha && s.alpha < m.alpha) : [];
    const pass = Math.max(0, ...between.map((s) => s.error));
    if (last && pass < 1.01 * Math.max(last.error, m.error)) {
      if (m.error < last.error) dips[dips.length - 1] = m;
    } else {
      dips.push(m);
    }
  }
  return dips;
}

export class Chart {
  // `on_try(α, live)`: a gain to be tried; α null is the best one again.
  constructor(canvas, on_try) {
    this.canvas = canvas;
    this.on_try = on_try;
    this.curves = []; // {history, color, length, best}
    this.alpha = null;
    this.range = [1e-3, 1e3];
    canvas.addEventListener('pointerdown', (event) => {
      if (!this.curves.length) return;
      canvas.setPointerCapture(event.pointerId);
      this.dragging = true;
      canvas.focus({ preventScroll: true });
      this.try_at(event, true);
    });
    canvas.addEventListener('pointermove', (event) => this.dragging && this.try_at(event, true));
    const end = (event) => {
      if (!this.dragging) return;
      this.dragging = false;
      this.try_at(event, false);
    };
    canvas.addEventListener('pointerup', end);
    canvas.addEventListener('pointercancel', () => (this.dragging = false));
    canvas.addEventListener('dblclick', () => this.on_try(null, false));
    canvas.addEventListener('keydown', (event) => this.key(event));
  }

  key(event) {
    const factor = 10 ** (event.shiftKey ? 1 / 8 : 1 / 64);
    const [low, high] = this.range;
    const now = this.alpha ?? this.curves[0]?.best ?? low;
    let next;
    if (event.key === 'ArrowRight' || event.key === 'ArrowUp') next = Math.min(high, Math.max(low, now * factor));
    else if (event.key === 'ArrowLeft' || event.key === 'ArrowDown') next = now <= low ? 0 : Math.max(low, now / factor);
    else if (event.key === 'Home') next = 0;
    else if (event.key === 'End') next = high;
    else if (event.key === 'Enter' || event.key === 'Escape') next = null;
    else return;
    event.preventDefault();
    event.stopPropagation();
    this.on_try(next, false);
  }

  try_at(event, live) {
    const box = this.canvas.getBoundingClientRect();
    const x = event.clientX - box.left;
    let alpha = this.alpha_at(x);
    for (const { best, history } of this.curves) {
      for (const m of [{ alpha: best }, ...minima(history)]) {
        if (m.alpha > 0 && Math.abs(this.x(m.alpha) - x) < 5) alpha = m.alpha;
      }
    }
    this.on_try(alpha, live);
  }

  get plot() {
    return { left: margin.left + zero_width, right: this.width - margin.right, top: margin.top, bottom: this.height - margin.bottom };
  }
  x(alpha) {
    const { left, right } = this.plot;
    if (!(alpha > 0)) return margin.left + 4;
    const [low, high] = this.range;
    const share = Math.log(alpha / low) / Math.log(high / low);
    return left + Math.max(0, Math.min(1, share)) * (right - left);
  }
  alpha_at(x) {
    const { left, right } = this.plot;
    if (x < left - zero_width / 2) return 0;
    const [low, high] = this.range;
    const share = Math.max(0, Math.min(1, (x - left) / (right - left)));
    return Number((low * (high / low) ** share).toPrecision(6));
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
    const { left, right, top, bottom } = this.plot;
    if (!this.curves.length) return;

    const samples = this.curves.flatMap(({ history }) => history);
    const positive = samples.filter((s) => s.alpha > 0).map((s) => s.alpha);
    if (!positive.length) return;
    this.range = [Math.min(...positive), Math.max(...positive)];
    const shares = this.curves.flatMap(({ history, length }) => history.map((s) => s.error / length)).filter((e) => e > 0);
    let low = Math.min(...shares) / 1.5, high = Math.min(Math.max(...shares) * 1.3, 100 * low * 100);
    if (high / low < 4) [low, high] = [low / 1.5, high * 1.5];
    const y = (share) => {
      const t = Math.log(Math.max(share, low) / low) / Math.log(high / low);
      return bottom - Math.min(1.02, t) * (bottom - top);
    };

    // Axes: 1, 2, 5 upwards while there is room; decades along.
    ctx.lineWidth = 1;
    ctx.textBaseline = 'middle';
    ctx.textAlign = 'right';
    let last = Infinity;
    for (let decade = Math.floor(Math.log10(low)); decade <= Math.log10(high); decade++) {
      for (const digit of [1, 2, 5]) {
        const share = digit * 10 ** decade;
        if (share < low || share > high || last - y(share) < 17) continue;
        last = y(share);
        ctx.strokeStyle = colors.grid;
        ctx.beginPath();
        ctx.moveTo(margin.left, Math.round(last) + 0.5);
        ctx.lineTo(right, Math.round(last) + 0.5);
        ctx.stroke();
        ctx.fillStyle = colors.quiet;
        ctx.fillText(`${Number((100 * share).toPrecision(1))} %`, margin.left - 5, last);
      }
    }
    ctx.textAlign = 'center';
    ctx.textBaseline = 'top';
    ctx.fillStyle = colors.quiet;
    ctx.fillText('0', this.x(0), bottom + 6);
    for (let decade = Math.ceil(Math.log10(this.range[0])); decade <= Math.log10(this.range[1]); decade++) {
      const at = this.x(10 ** decade);
      ctx.strokeStyle = colors.grid;
      ctx.beginPath();
      ctx.moveTo(Math.round(at) + 0.5, top);
      ctx.lineTo(Math.round(at) + 0.5, bottom);
      ctx.stroke();
      if (at < right - 16) ctx.fillText(decade >= -3 && decade < 4 ? String(Number((10 ** decade).toPrecision(1))) : `1e${decade}`.replace('-', '−'), at, bottom + 6);
    }
    ctx.textAlign = 'right';
    ctx.fillText('N/m', this.width - 2, bottom + 6);

    for (const { history, color, length } of this.curves) {
      ctx.strokeStyle = color;
      ctx.lineWidth = 1.75;
      ctx.lineJoin = 'round';
      ctx.beginPath();
      let begun = false;
      for (const s of history) {
        if (!(s.alpha > 0)) continue;
        begun ? ctx.lineTo(this.x(s.alpha), y(s.error / length)) : ctx.moveTo(this.x(s.alpha), y(s.error / length));
        begun = true;
      }
      ctx.stroke();
      const launch_only = history.find((s) => s.alpha === 0);
      if (launch_only) this.dot(ctx, this.x(0), y(launch_only.error / length), 3, color, color);
      for (const m of minima(history)) {
        if (m.alpha > 0) this.dot(ctx, this.x(m.alpha), y(m.error / length), 3, colors.panel, color);
      }
    }
    for (const { history, color, length, best } of this.curves) {
      const at = history.find((s) => s.alpha === best);
      if (at) this.dot(ctx, this.x(best), y(at.error / length), 4.5, color, colors.panel);
    }
    if (this.alpha !== null) {
      const at = this.x(this.alpha);
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
    }
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
