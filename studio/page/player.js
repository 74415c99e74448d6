// The flight in time: play, pause, scrub.

import { digits } from './numbers.js';
import { app, end_time, now, scene } from './state.js';

const $ = (id) => document.getElementById(id);

const pause_at_end = 0.35; // seconds, before a loop starts again
const longest_tick = 0.1; // seconds: a page in the background does not jump

export class Player {
  // `draw()` draws the stage at once.
  constructor(draw) {
    this.draw = draw;
    this.last_tick = 0;
    $('time').addEventListener('input', (event) => this.go_to((Number(event.target.value) / 1000) * end_time()));
    $('speed').addEventListener('change', (event) => (app.speed = Number(event.target.value)));
  }

  tick(stamp) {
    if (!app.playing) return;
    const end = end_time();
    const passed = Math.min(longest_tick, (stamp - this.last_tick) / 1000);
    this.last_tick = stamp;
    app.time = (app.time ?? 0) + passed * app.speed;
    if (app.time >= end + (app.loop ? pause_at_end * app.speed : 0)) {
      if (!app.loop) return this.play(false);
      app.time = 0;
    }
    const shown = app.time;
    app.time = Math.min(app.time, end);
    this.draw();
    app.time = shown;
    requestAnimationFrame((next) => this.tick(next));
  }

  play(on) {
    app.playing = on;
    if (on && (app.time === null || app.time >= end_time())) app.time = 0;
    if (!on && app.time !== null && app.time > end_time()) app.time = end_time();
    $('play-icon').setAttribute('d', on ? 'M8 5v14M16 5v14' : 'M8 5v14l11-7z');
    $('play-icon').setAttribute('stroke-width', on ? 3.5 : 1.7);
    $('play').setAttribute('aria-label', on ? 'Pause' : 'Play');
    this.last_tick = performance.now();
    if (on) requestAnimationFrame((stamp) => this.tick(stamp));
    this.draw();
  }

  pause() {
    if (app.playing) this.play(false);
  }

  go_to(time) {
    this.pause();
    const t0 = scene().arrival_time;
    app.time = Math.max(0, Math.min(end_time(), time));
    if (Math.abs(app.time - t0) < 0.006 * t0) app.time = null; // the mark holds
    this.draw();
  }

  show_clock() {
    const t0 = scene().arrival_time;
    const slider = $('time');
    slider.value = Math.round(1000 * Math.min(1, now() / end_time()));
    slider.setAttribute('aria-valuetext', `${now().toFixed(2)} of ${t0.toFixed(2)} seconds`);
    const text = `${now().toFixed(2)} / ${digits(t0)} s`;
    if ($('clock').textContent !== text) $('clock').textContent = text;
    const mark = Math.min(1, t0 / end_time());
    const left = `calc(${100 * mark}% + ${8 - 16 * mark - 1}px)`;
    if ($('arrival-mark').style.left !== left) $('arrival-mark').style.left = left;
  }
}
