'use strict';
// Plays what the page holds: for each scene and gain, both engines' frames as whole numbers, each
// the change of the change since the frame before.

const svgSpace = 'http://www.w3.org/2000/svg';
const scenes = JSON.parse(document.getElementById('flights').textContent);

function element(parent, name, attributes, text) {
  const made = document.createElementNS(svgSpace, name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  if (text !== undefined) made.textContent = text;
  parent.append(made);
  return made;
}

function unpacked(flat, size, unit) {
  const frames = [];
  const place = new Int32Array(size);
  const change = new Int32Array(size);
  for (let start = 0; start < flat.length; start += size) {
    for (let i = 0; i < size; ++i) place[i] += change[i] += flat[start + i];
    frames.push(Float64Array.from(place, (value) => value * unit));
  }
  return frames;
}

function roundTicks(low, high, count) {
  const rough = (high - low) / Math.max(1, count);
  const decade = 10 ** Math.floor(Math.log10(rough));
  const m = rough / decade;
  const step = decade * (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * (high - low); ++i) {
    ticks.push([i * step, (i * step + 0).toFixed(digits).replace('-', '−')]);
  }
  return ticks;
}

const percent = (value) => `${value < 0.0995 ? value.toFixed(3) : value.toFixed(2)} %`;

class SceneView {
  constructor(root, data) {
    this.root = root;
    this.data = data;
    this.find = (name) => root.querySelector(`[data-part="${name}"]`);
    this.size = data.dimension * data.particles;
    // From where a sheet is seen: as in the figures, until it is turned.
    this.azimuth = (25 * Math.PI) / 180;
    this.elevation = (20 * Math.PI) / 180;
    this.target = Float64Array.from(data.target, (value) => value * data.unit);
    this.choice = 0;
    this.time = data.times[data.times.length - 1];
    this.end = this.time;
    this.speed = 1;
    this.playing = 0;
    this.cache = new Map();
    if (data.faces) {
      const canvas = document.createElement('canvas');
      canvas.className = 'sheet';
      this.painter = new SheetPainter(canvas, data.faces, data.ground);
    }

    this.slider = this.find('time');
    this.button = this.find('play');
    this.slider.max = String(this.end);
    this.slider.addEventListener('input', () => {
      this.pause();
      this.show(Number(this.slider.value));
    });
    this.button.addEventListener('click', () => (this.playing ? this.pause() : this.play()));
    this.find('speed').addEventListener('change', (event) => {
      this.speed = Number(event.target.value);
    });
    this.find('gains').addEventListener('change', (event) => {
      this.choose(Number(event.target.value));
    });
    this.find('pareto-front').addEventListener('click', (event) => this.pick(event));
    this.find('most').addEventListener('click', () => {
      this.pause();
      this.show(this.most.time);
    });
    this.choose(0);
    let width = 0;
    new ResizeObserver(([entry]) => {
      if (Math.abs(entry.contentRect.width - width) < 1) return;
      width = entry.contentRect.width;
      this.draw(width);
    }).observe(this.find('stage'));
  }

  frames(engine) {
    const key = `${this.choice}/${engine}`;
    if (!this.cache.has(key)) {
      const flat = this.data.choices[this.choice].frames[engine];
      this.cache.set(key, unpacked(flat, this.size, this.data.unit));
    }
    return this.cache.get(key);
  }

  /// Both engines at the chosen gains: where they differ most, and how far they are apart always.
  choose(choice) {
    this.choice = choice;
    const [first, second] = [this.frames(0), this.frames(1)];
    this.most = { apart: -1, time: 0, particle: 0 };
    this.apart = first.map((pose, k) => {
      let sum = 0;
      for (let i = 0; i < this.data.particles; ++i) {
        const d = this.distance(pose, second[k], i);
        sum += d;
        if (d > this.most.apart) this.most = { apart: d, time: this.data.times[k], particle: i };
      }
      return (100 * sum) / this.data.particles / this.data.length;
    });
    const most = `${percent((100 * this.most.apart) / this.data.length)} of L at ` +
      `${this.most.time.toFixed(2)} s`;
    this.find('most').textContent = `The engines differ most by ${most}: go there`;
    this.find('most-print').textContent = `The engines differ most by ${most}.`;
    const cursor = this.root.querySelector('.cursor');
    const gain = this.data.choices[choice].gains[0];
    const { left, right, zero, low, high } = cursor.dataset;
    const s = Math.log(gain / low) / Math.log(high / low);
    const x = gain <= 0 ? Number(zero) : Number(left) + Math.max(0, Math.min(1, s)) * (right - left);
    cursor.setAttribute('transform', `translate(${x} 0)`);
    for (const rings of this.root.querySelectorAll('.rings-of')) {
      rings.classList.toggle('on', Number(rings.dataset.choice) === choice);
    }
    this.data.choices[choice].readings.forEach((readings, engine) => {
      readings.forEach((text, i) => { this.find(`reading-${engine}-${i}`).textContent = text; });
    });
    if (this.plot) this.drawOver();
  }

  /// The dot of the pareto-front next to a click, if one is near: its button among the gains, so that
  /// keys go on from there.
  pick(click) {
    let [choice, nearest] = [null, 24];
    for (const dots of this.root.querySelectorAll('.dots-of')) {
      for (const dot of dots.children) {
        const box = dot.getBoundingClientRect();
        const distance = Math.hypot((box.left + box.right) / 2 - click.clientX,
          (box.top + box.bottom) / 2 - click.clientY);
        if (distance < nearest) [choice, nearest] = [dots.dataset.choice, distance];
      }
    }
    if (choice === null) return;
    const button = this.find('gains').querySelector(`[value="${choice}"]`);
    button.checked = true;
    button.focus({ preventScroll: true });
    this.choose(Number(choice));
  }

  draw(width) {
    this.width = width;
    const { data } = this;
    const stage = this.find('stage');
    stage.replaceChildren();
    let [left, right, bottom, top] = [Infinity, -Infinity, Infinity, -Infinity];
    const add = (shape) => {
      const pose = this.seen(shape);
      for (let i = 0; i < pose.length; i += 2) {
        left = Math.min(left, pose[i]);
        right = Math.max(right, pose[i]);
        bottom = Math.min(bottom, pose[i + 1]);
        top = Math.max(top, pose[i + 1]);
      }
    };
    add(this.target);
    const addShadow = (pose) => add(pose.map((value, i) => (i % 3 === 1 ? data.ground : value)));
    if (this.painter) [this.target, this.frames(0)[0]].forEach(addShadow);
    const chosen = this.choice;
    for (this.choice = 0; this.choice < data.choices.length; ++this.choice) {
      for (const engine of [0, 1]) this.frames(engine).forEach(add);
    }
    this.choice = chosen;
    const margin = 0.05 * Math.max(right - left, top - bottom);
    [left, right, bottom, top] = [left - margin, right + margin, bottom - margin, top + margin];

    const frame = { left: 44, top: 10, width: width - 62 };
    frame.height = Math.min(Math.max((frame.width * (top - bottom)) / (right - left), 180), 460);
    const scale = Math.max((right - left) / frame.width, (top - bottom) / frame.height);
    left = (left + right - scale * frame.width) / 2;
    bottom = (bottom + top - scale * frame.height) / 2;
    this.plot = {
      frame,
      x: (x) => frame.left + (x - left) / scale,
      y: (y) => frame.top + frame.height - (y - bottom) / scale,
    };
    const height = frame.top + frame.height + 40;
    const svg = element(stage, 'svg', {
      class: 'figure', viewBox: `0 0 ${width} ${height}`, width, height, role: 'img',
      'aria-label': `${data.name}: both engines' cloths over the target`,
    });
    this.svg = svg;
    const inSpace = data.dimension === 3;
    if (inSpace) this.makeTurnable(svg);
    for (const [value, label] of roundTicks(left, left + scale * frame.width, frame.width / 70)) {
      const x = this.plot.x(value);
      element(svg, 'line', { class: 'line grid', x1: x, x2: x, y1: frame.top, y2: frame.top + frame.height });
      element(svg, 'text', { class: 'muted', x, y: frame.top + frame.height + 16, 'text-anchor': 'middle' }, label);
    }
    for (const [value, label] of roundTicks(bottom, bottom + scale * frame.height, frame.height / 45)) {
      const y = this.plot.y(value);
      element(svg, 'line', { class: 'line grid', x1: frame.left, x2: frame.left + frame.width, y1: y, y2: y });
      element(svg, 'text', { class: 'muted', x: frame.left - 6, y: y + 4, 'text-anchor': 'end' }, label);
    }
    element(svg, 'text', { x: frame.left + frame.width / 2, y: height - 4, 'text-anchor': 'middle' }, inSpace ? 'across [m]' : 'x [m]');
    element(svg, 'text', { transform: `translate(11 ${frame.top + frame.height / 2}) rotate(-90)`, 'text-anchor': 'middle' }, inSpace ? 'up [m]' : 'y [m]');
    if (this.painter) {
      stage.append(this.painter.canvas);
      this.painter.resize(width, height);
    } else element(svg, 'polyline', { class: 'line band', points: this.points(this.target) });
    this.over = element(svg, 'g', {});
    this.drawOver();
  }

  /// A pose as the page shows it, x and y of each particle: a sheet from where it is seen.
  seen(pose) {
    if (this.data.dimension === 2) return pose;
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    const flat = new Float64Array((2 * pose.length) / 3);
    for (let i = 0, k = 0; i < pose.length; i += 3) {
      flat[k++] = ca * pose[i] - sa * pose[i + 2];
      flat[k++] = ce * pose[i + 1] - se * (sa * pose[i] + ca * pose[i + 2]);
    }
    return flat;
  }

  /// Turned by dragging or by the arrow keys.
  makeTurnable(svg) {
    svg.classList.add('turnable');
    svg.setAttribute('tabindex', '0');
    svg.setAttribute('aria-label', `${svg.getAttribute('aria-label')}; drag it or use the arrow keys to turn it`);
    svg.addEventListener('keydown', (event) => {
      const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!turn) return;
      event.preventDefault();
      this.turn(0.1 * turn[0], 0.1 * turn[1]);
      this.svg.focus({ preventScroll: true });
    });
    svg.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      let [x, y] = [event.clientX, event.clientY];
      const stop = new AbortController();
      addEventListener('pointermove', (move) => {
        this.turn(0.008 * (x - move.clientX), 0.008 * (move.clientY - y));
        [x, y] = [move.clientX, move.clientY];
      }, { signal: stop.signal });
      for (const end of ['pointerup', 'pointercancel']) {
        addEventListener(end, () => stop.abort(), { signal: stop.signal });
      }
    });
  }

  turn(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = Math.max(-1.5, Math.min(1.5, this.elevation + elevation));
    this.draw(this.width);
  }

  distance(a, b, particle) {
    let sum = 0;
    const first = this.data.dimension * particle;
    for (let i = first; i < first + this.data.dimension; ++i) sum += (a[i] - b[i]) ** 2;
    return Math.sqrt(sum);
  }

  meanDistance(a, b) {
    let sum = 0;
    for (let i = 0; i < this.data.particles; ++i) sum += this.distance(a, b, i);
    return sum / this.data.particles;
  }

  /// Of x and y of one point after another.
  line(flat) {
    const { x, y } = this.plot;
    let text = '';
    for (let i = 0; i < flat.length; i += 2) {
      text += `${x(flat[i]).toFixed(1)},${y(flat[i + 1]).toFixed(1)} `;
    }
    return text;
  }

  /// The cloth's line.
  points(pose) {
    const flat = this.seen(pose);
    const along = this.data.stroke.flatMap((i) => [flat[2 * i], flat[2 * i + 1]]);
    return this.line(along);
  }

  pose(engine, time) {
    const { times } = this.data;
    const frames = this.frames(engine);
    let k = 1;
    while (k + 1 < times.length && times[k] < time) ++k;
    const s = Math.max(0, Math.min(1, (time - times[k - 1]) / (times[k] - times[k - 1])));
    return frames[k].map((value, i) => (1 - s) * frames[k - 1][i] + s * value);
  }

  /// All that depends on the gain.
  drawOver() {
    const { over, data } = this;
    over.replaceChildren();
    if (!this.painter) {
      element(over, 'polyline', { class: 'line soft thin', points: this.points(this.frames(0)[0]) });
    }
    const path = this.frames(0).flatMap((pose) => {
      const flat = this.seen(pose);
      let [x, y] = [0, 0];
      for (let i = 0; i < flat.length; i += 2) [x, y] = [x + flat[i], y + flat[i + 1]];
      return [x / data.particles, y / data.particles];
    });
    element(over, 'polyline', { class: 'line soft dots', points: this.line(path) });
    for (const engine of this.painter ? [] : [0, 1]) {
      for (let k = 1; k <= 4; ++k) {
        element(over, 'polyline', {
          class: `line ghost ${engine ? 'b dashes' : 'a'}`,
          points: this.points(this.pose(engine, (this.end * k) / 5)),
        });
      }
    }
    this.cloths = [0, 1].map((engine) =>
      element(over, 'polyline', {
        class: `line thick ${engine ? 'b dashes' : 'a'}`,
      }));
    this.ring = element(over, 'circle', { class: 'line', r: 11 });
    this.drawApart();
    this.show(this.time);
  }

  /// How far the engines are apart, over the time that the slider runs.
  drawApart() {
    const box = this.find('apart');
    box.replaceChildren();
    const width = box.clientWidth;
    const frame = { left: 44, right: width - 18, top: 12, bottom: 62 };
    const svg = element(box, 'svg', {
      class: 'figure', viewBox: `0 0 ${width} 96`, width, height: 96, role: 'img',
      'aria-label': 'Mean distance of the two engines over time',
    });
    const largest = Math.max(...this.apart, 1e-6);
    const x = (time) => frame.left + (time / this.end) * (frame.right - frame.left);
    const y = (apart) => frame.bottom - (apart / largest) * (frame.bottom - frame.top);
    for (const [value, label] of roundTicks(0, this.end, (frame.right - frame.left) / 80)) {
      element(svg, 'line', { class: 'line grid', x1: x(value), x2: x(value), y1: frame.top, y2: frame.bottom + 4 });
      element(svg, 'text', { class: 'muted', x: x(value), y: frame.bottom + 17, 'text-anchor': 'middle' }, label);
    }
    for (const [value, label] of roundTicks(0, largest, 2)) {
      element(svg, 'line', { class: 'line grid', x1: frame.left, x2: frame.right, y1: y(value), y2: y(value) });
      element(svg, 'text', { class: 'muted', x: frame.left - 6, y: y(value) + 4, 'text-anchor': 'end' }, label);
    }
    element(svg, 'polyline', {
      class: 'line', points: this.apart.map((value, k) => `${x(this.data.times[k]).toFixed(1)},${y(value).toFixed(1)}`).join(' '),
    });
    element(svg, 'text', { x: (frame.left + frame.right) / 2, y: 94, 'text-anchor': 'middle' }, 'time [s]');
    this.now = element(svg, 'line', { class: 'line soft', y1: frame.top, y2: frame.bottom });
    this.nowX = x;
  }

  show(time) {
    this.time = time;
    const arrived = time >= this.end - 1e-9;
    const { data } = this;
    this.slider.value = String(time);
    this.slider.setAttribute('aria-valuetext', `${time.toFixed(2)} s`);
    const clock = this.find('clock');
    clock.textContent = arrived ? `${time.toFixed(2)} s, arrival` : `${time.toFixed(2)} s`;
    clock.classList.toggle('arrived', arrived);
    const poses = [this.pose(0, time), this.pose(1, time)];
    const errors = poses.map((pose, engine) => {
      if (arrived) return 100 * data.choices[this.choice].errors[engine];
      return (100 * this.meanDistance(pose, this.target)) / data.length;
    });
    const apart = (100 * this.meanDistance(poses[0], poses[1])) / data.length;
    this.find('error-0').textContent = percent(errors[0]);
    this.find('error-1').textContent = percent(errors[1]);
    this.find('apart-now').textContent = percent(apart);
    this.find('what').textContent = arrived ? 'error' : 'to the target';
    this.find('what-1').textContent = arrived ? 'error' : 'to the target';
    if (!this.plot) return;
    if (!this.painter) {
      poses.forEach((pose, engine) => this.cloths[engine].setAttribute('points', this.points(pose)));
    }
    // The ring shows the particle that is furthest apart, while it is.
    const step = 0.5 / 60 + this.end / data.times.length;
    const here = Math.abs(time - this.most.time) <= step;
    this.ring.style.display = here ? '' : 'none';
    const [first, second] = poses.map((pose) => this.seen(pose));
    const i = 2 * this.most.particle;
    this.ring.setAttribute('cx', this.plot.x((first[i] + second[i]) / 2));
    this.ring.setAttribute('cy', this.plot.y((first[i + 1] + second[i + 1]) / 2));
    if (this.painter) this.paintSheet(poses, here);
    this.now.setAttribute('x1', this.nowX(time));
    this.now.setAttribute('x2', this.nowX(time));
  }

  /// Upon all else of the drawing, the ring too.
  paintSheet([first, second], hasRing) {
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    this.painter.paint([
      { flat: this.frames(0)[0], color: 'soft', opacity: 0.6 },
      { flat: this.target, color: 'target', opacity: 0.6 },
      { flat: second, color: 'b', opacity: 1, outlined: true },
      { flat: first, color: 'a', opacity: 0.85, shadow: true },
    ], { seen: (flat) => this.seen(flat), plot: this.plot, eye: [sa * ce, se, ca * ce] },
    hasRing ? ['cx', 'cy'].map((name) => Number(this.ring.getAttribute(name))) : null);
  }

  play() {
    for (const view of views) view.pause();
    if (this.time >= this.end - 1e-9) this.time = 0;
    this.button.textContent = 'Pause';
    let before = performance.now();
    const tick = (now) => {
      const time = Math.min(this.end, this.time + ((now - before) / 1000) * this.speed);
      before = now;
      this.show(time);
      if (time >= this.end) this.pause();
      else this.playing = requestAnimationFrame(tick);
    };
    this.playing = requestAnimationFrame(tick);
  }

  pause() {
    cancelAnimationFrame(this.playing);
    this.playing = 0;
    this.button.textContent = this.time >= this.end - 1e-9 ? 'Replay' : 'Play';
  }
}

const views = [...document.querySelectorAll('.scene')].map((root, i) => new SceneView(root, scenes[i]));
for (const view of views) view.pause();
// On paper: the arrival.
addEventListener('beforeprint', () => views.forEach((view) => { view.pause(); view.show(view.end); }));
