// Pointer and keyboard on the stage: drawing, moving, turning, scaling, single points, the camera.

import * as geometry from './geometry.js';

const pen_reach = 12, finger_reach = 24; // pixels

export class Editor {
  // app: {doc, selected, tool, vertex, changed(live, time), drawn(), select(name), redraw()}
  constructor(canvas, view, app) {
    Object.assign(this, { canvas, view, app });
    this.pointers = new Map();
    this.gesture = null;
    this.space = false;
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.up(event));
    canvas.addEventListener('pointercancel', (event) => this.cancel(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  get line() { return this.app.doc.scene[this.app.selected]; }
  set line(points) { this.app.doc.scene[this.app.selected] = geometry.rounded(points); }

  place(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }
  // A gesture stays in the view in which it began.
  in_view(event) { return this.view.in_view(this.place(event), this.gesture ? this.gesture_view : undefined); }
  world(event) { return this.view.to_world(this.in_view(event)); }
  reach(event) { return event.pointerType === 'touch' ? finger_reach : pen_reach; }

  // What a pointer at this place would take.
  target_at(event) {
    const [x, y] = this.in_view(event);
    const reach = this.reach(event);
    const world = this.world(event);
    const scene = this.app.doc.scene;
    const far = (name) => geometry.distance_to_line(scene[name], world) * this.view.camera.scale;
    if (this.app.tool === 'move') {
      for (const [name, [hx, hy]] of Object.entries(this.view.handle_places(this.line))) {
        if (Math.hypot(hx - x, hy - y) <= reach) return { kind: name === 'turn' ? 'turn' : 'scale', handle: name };
      }
    }
    const other = this.app.selected === 'target' ? 'initial' : 'target';
    if (this.app.tool === 'move' && far(other) <= reach && far(this.app.selected) > far(other)) return { kind: 'move', name: other };
    if (far(this.app.selected) <= reach) return { kind: 'move', name: this.app.selected };
    if (this.app.tool === 'points') return far(other) <= reach ? { kind: 'move', name: other } : null;
    const frame = (name) => this.view.frame(scene[name]);
    for (const name of [this.app.selected, other]) {
      const { left, right, top, bottom } = frame(name);
      if (x >= left && x <= right && y >= top && y <= bottom) return { kind: 'move', name };
    }
    return null;
  }

  down(event) {
    if (event.button === 2) return;
    event.preventDefault();
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, this.place(event));
    if (this.pointers.size === 2) return this.begin_pinch();
    if (this.pointers.size > 2) return;
    this.gesture_view = this.view.view_at(this.place(event));
    const at = this.world(event);
    const { tool } = this.app;
    if (tool === 'pan' || this.space || event.button === 1) {
      this.gesture = { kind: 'pan', last: this.place(event) };
    } else if (tool === 'draw') {
      this.gesture = { kind: 'draw', points: [at] };
    } else {
      const hit = this.target_at(event);
      if (hit?.name && hit.name !== this.app.selected) this.app.select(hit.name);
      if (!hit) {
        this.gesture = { kind: 'pan', last: this.place(event) };
      } else if (tool === 'points' && hit.kind === 'move') {
        const index = geometry.nearest_vertex(this.line, at);
        this.app.vertex = index;
        this.gesture = { kind: 'vertex', index, from: at, line: this.line };
      } else if (hit.kind === 'scale') {
        const { left, right, top, bottom } = this.view.frame(this.line);
        const opposite = { nw: [right, bottom], ne: [left, bottom], sw: [right, top], se: [left, top] }[hit.handle];
        this.gesture = { kind: 'scale', about: this.view.to_world(opposite), from: at, line: this.line };
      } else if (hit.kind === 'turn') {
        this.gesture = { kind: 'turn', about: geometry.centroid(this.line), from: at, line: this.line };
      } else {
        this.gesture = { kind: 'move', from: at, line: this.line };
      }
    }
    this.app.redraw();
  }

  move(event) {
    if (this.pointers.has(event.pointerId)) this.pointers.set(event.pointerId, this.place(event));
    if (this.gesture?.kind === 'pinch') return this.pinch();
    if (!this.gesture) return this.hover(event);
    if (event.pointerId !== [...this.pointers.keys()][0]) return;
    const gesture = this.gesture;
    const [x, y] = this.world(event);
    if (gesture.kind === 'pan') {
      const [px, py] = this.place(event);
      this.view.pan(px - gesture.last[0], py - gesture.last[1]);
      gesture.last = [px, py];
      return this.app.redraw();
    }
    if (gesture.kind === 'draw') {
      const finer = event.getCoalescedEvents?.() ?? [];
      for (const e of finer.length ? finer : [event]) gesture.points.push(this.world(e));
      return this.app.redraw();
    }
    const [fx, fy] = gesture.from;
    if (gesture.kind === 'move') {
      this.line = geometry.moved(gesture.line, x - fx, y - fy);
    } else if (gesture.kind === 'vertex') {
      this.line = geometry.vertex_moved(gesture.line, gesture.index, x - fx, y - fy, event.shiftKey);
    } else if (gesture.kind === 'scale') {
      const [ax, ay] = gesture.about;
      const square = (fx - ax) ** 2 + (fy - ay) ** 2;
      const factor = ((x - ax) * (fx - ax) + (y - ay) * (fy - ay)) / square;
      this.line = geometry.scaled(gesture.line, Math.max(0.02, factor), gesture.about);
    } else if (gesture.kind === 'turn') {
      const [ax, ay] = gesture.about;
      let angle = Math.atan2(y - ay, x - ax) - Math.atan2(fy - ay, fx - ax);
      if (event.shiftKey) angle = Math.round(angle / (Math.PI / 12)) * (Math.PI / 12);
      this.line = geometry.rotated(gesture.line, angle, gesture.about);
    }
    gesture.changed = true;
    this.app.changed(true, event.timeStamp);
  }

  up(event) {
    this.pointers.delete(event.pointerId);
    const gesture = this.gesture;
    if (!gesture) return;
    if (gesture.kind === 'pinch') {
      if (this.pointers.size === 0) this.gesture = null;
      return;
    }
    this.gesture = null;
    if (gesture.kind === 'draw') {
      const line = geometry.stroke(gesture.points);
      // A tap is no stroke.
      if (line && geometry.length(line) * this.view.camera.scale > 12) {
        this.line = line;
        this.app.vertex = null;
        this.app.drawn();
      } else {
        this.app.redraw();
      }
    } else if (gesture.changed) {
      this.app.changed(false);
    }
  }

  cancel(event) {
    this.pointers.delete(event.pointerId);
    if (this.gesture?.changed) {
      this.app.doc.revert();
      this.app.changed(false);
    }
    this.gesture = null;
    this.app.redraw();
  }

  begin_pinch() {
    if (this.gesture?.changed) {
      this.app.doc.revert();
      this.app.changed(false);
    }
    this.gesture = { kind: 'pinch', last: [...this.pointers.values()] };
    this.app.redraw();
  }

  pinch() {
    const [a, b] = [...this.pointers.values()];
    if (!b) return;
    const [c, d] = this.gesture.last;
    const middle = (p, q) => [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
    const now = middle(a, b), before = middle(c, d);
    this.view.pan(now[0] - before[0], now[1] - before[1]);
    const spread = Math.hypot(a[0] - b[0], a[1] - b[1]) / Math.max(1, Math.hypot(c[0] - d[0], c[1] - d[1]));
    this.view.zoom(spread, this.view.in_view(now));
    this.gesture.last = [a, b];
    this.app.redraw();
  }

  hover(event) {
    const { tool } = this.app;
    let cursor = 'grab';
    if (tool === 'draw') cursor = 'crosshair';
    else if (tool !== 'pan' && !this.space) {
      const hit = this.target_at(event);
      if (hit) {
        cursor = { turn: 'crosshair', move: tool === 'points' ? 'pointer' : 'move' }[hit.kind] ??
                 (hit.handle === 'nw' || hit.handle === 'se' ? 'nwse-resize' : 'nesw-resize');
      }
    }
    this.canvas.style.cursor = cursor;
  }

  wheel(event) {
    event.preventDefault();
    const step = event.deltaMode === 1 ? 20 * event.deltaY : event.deltaY;
    this.view.zoom(Math.exp(-Math.max(-300, Math.min(300, step)) * 0.0015), this.in_view(event));
    this.app.redraw();
  }

  // The keys of the stage; says whether it took the key.
  key(event) {
    const app = this.app;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const by_arrow = arrows[event.key];
    const change = (line) => {
      this.line = line;
      app.changed(false);
      return true;
    };
    if (by_arrow) {
      const step = (event.shiftKey ? 10 : 1) * 10 ** Math.round(Math.log10(geometry.length(this.line)) - 2);
      const [dx, dy] = by_arrow.map((d) => d * step);
      if (app.tool === 'points' && app.vertex !== null) {
        return change(geometry.vertex_moved(this.line, Math.min(app.vertex, this.line.length - 1), dx, dy, event.altKey));
      }
      if (app.tool === 'pan') {
        this.view.pan(-40 * by_arrow[0], 40 * by_arrow[1]);
        app.redraw();
        return true;
      }
      return change(geometry.moved(this.line, dx, dy));
    }
    switch (event.key) {
      case '[': return change(geometry.rotated(this.line, Math.PI / 36));
      case ']': return change(geometry.rotated(this.line, -Math.PI / 36));
      case '<': return change(geometry.scaled(this.line, 1 / 1.05));
      case '>': return change(geometry.scaled(this.line, 1.05));
      case '+': case '=': this.view.zoom(1.2); app.redraw(); return true;
      case '-': this.view.zoom(1 / 1.2); app.redraw(); return true;
      case 'n': case 'b': {
        if (app.tool !== 'points') return false;
        const count = this.line.length;
        app.vertex = app.vertex === null ? 0 : (app.vertex + (event.key === 'n' ? 1 : count - 1)) % count;
        app.redraw();
        return true;
      }
    }
    return false;
  }
}
