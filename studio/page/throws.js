// The throws that the page asks the program for: while a hand moves no more than what is drawn
// meanwhile, and the whole answer at rest.

import { ask, Channel } from './client.js';
import { Latency } from './latency.js';
import { app, is_sheet, length_of, no_refining, other_engine, particles, scene, shows, time_after } from './state.js';

const frames_while_moving = 12;
const frames_per_second = 60;
const most_frames = 480;
const most_points = 300000; // of all frames
// A hand that holds still so long gets the whole answer [ms]; a sheet's takes longer, and is not to
// stand in the way of the next move.
const rest = () => (is_sheet() ? 400 : 150);

const body = () => JSON.stringify(scene());

function frames_at_rest() {
  const wished = frames_per_second * scene().arrival_time * 2;
  return Math.max(2, Math.round(Math.min(most_frames, most_points / particles(), wished)));
}

export class Throws {
  // on: {shown() an answer is to be drawn, busy(whether), trouble(message or null)}
  constructor(on) {
    this.on = on;
    this.channels = Object.fromEntries(
      ['native', 'box2d', 'bullet', 'curve', 'pareto_front', 'file'].map((name) => [name, new Channel(name, () => this.settle())]));
    this.latency = new Latency();
    this.rest_due = 0;
    this.at_rest = true;
    this.others = 0; // other work that is under way
    this.settle_due = 0;
  }

  // ------------------------------------------------------------------------------- asking

  // As everything is when the request leaves, however long it waited to.
  async ask(path, parameters, page, signal) {
    const key = body(), move = this.latency.latest;
    const answer = await (await ask(path, { page, ...parameters() }, key, signal)).json();
    return { answer, key, move };
  }

  // Another scene is there: nothing that was asked of the one before is wanted.
  drop() {
    clearTimeout(this.rest_due);
    for (const channel of Object.values(this.channels)) channel.drop();
    this.settle();
  }

  // live: the scene is still changing.
  request(live) {
    clearTimeout(this.rest_due);
    // What is asked for at rest gives way to the hand.
    const urgent = !live || this.at_rest;
    this.at_rest = !live;
    const sampled = () => live ? { frames: frames_while_moving } : { frames: frames_at_rest(), after: time_after(), judge: 1 };
    const corrected = () => (!live && app.refines && !no_refining() ? { refine: 1 } : {});
    const run = (channel, path, parameters, done) => this.channels[channel].run({
      work: (page, signal) => this.ask(path, parameters, page, signal),
      done,
      failed: (error) => this.failed(channel, error),
      urgent,
    });

    const native = app.results.native?.best;
    const follows = live && native !== undefined;
    const after_native = (got) => {
      this.take('native', got);
      this.request_other(live, sampled, run);
      if (live) this.rest_due = setTimeout(() => this.request(false), rest());
      else this.request_pareto_front(run);
    };
    if (follows && app.alpha === null && is_sheet()) {
      // One flight and no search: the best gain hardly changes under the hand.
      run('native', 'simulate', () => ({ alpha: app.results.native.best, ...sampled() }), after_native);
    } else if (app.alpha === null) {
      run('native', 'optimize', () => ({ ...sampled(), ...corrected(), ...(follows ? { warm_start: app.results.native.best } : {}) }), (got) => {
        this.take_search('native', got, !follows);
        after_native(got);
      });
    } else {
      run('native', 'simulate', () => ({ alpha: app.alpha, ...sampled() }), after_native);
      if (!live && app.results.native?.curve?.key !== body()) {
        run('curve', 'optimize', () => ({}), (got) => {
          this.take_search('native', got, true);
          this.on.shown();
        });
      }
    }
    this.settle();
  }

  // The other engine with the gain of native waits for it; its own search waits for rest.
  request_other(live, sampled, run) {
    const other = other_engine();
    if (!shows(other)) return;
    const own = app.alpha === null && app.own_gain;
    if (own && app.results[other]) app.results[other].stale = true;
    if (own && live) return;
    const done = (got) => {
      if (own) this.take_search(other, got, true);
      this.take(other, got);
    };
    if (own) run(other, 'optimize', () => ({ backend: other, ...sampled() }), done);
    else run(other, 'simulate', () => ({ backend: other, alpha: app.alpha ?? app.results.native?.best, ...sampled() }), done);
  }

  request_pareto_front(run) {
    if (app.results.native?.pareto_front?.key === body()) return;
    run('pareto_front', 'pareto_front', () => ({}), ({ answer, key }) => {
      app.results.native.pareto_front = { points: answer.pareto_front, length: answer.cloth_length, key };
      this.on.shown();
    });
  }

  // ------------------------------------------------------------------------------- answers

  take(engine, { answer, key, move }) {
    this.on.trouble(null);
    const result = (app.results[engine] ??= {});
    Object.assign(result, { flight: answer, key, stale: false });
    if (answer.alpha === result.best && !answer.refinement) result.best_throw = { flight: answer, key };
    if (engine === 'native') this.latency.answer(move);
    this.on.shown();
  }

  // whole: all of E(α) was searched, not the last valley alone.
  take_search(engine, { answer, key }, whole) {
    const { alpha, evaluations, seconds, history } = answer.optimization;
    const result = (app.results[engine] ??= {});
    result.best = alpha;
    result.search = { evaluations, seconds };
    if (whole) result.curve = { history, best: alpha, length: length_of(answer), key };
  }

  failed(channel, error) {
    if (channel === 'pareto_front' || channel === 'curve') return; // the throw says what is wrong
    this.on.trouble(error.message);
    if (app.results[channel]) app.results[channel].stale = true;
    this.on.shown();
  }

  // ------------------------------------------------------------------------------- busy or not

  get busy() { return this.others > 0 || Object.values(this.channels).some((channel) => channel.busy); }

  // Says when all is done, and at once that something is not.
  settle() {
    if (this.busy) this.on.busy(true);
    this.settle_due ||= setTimeout(() => {
      this.settle_due = 0;
      this.on.busy(this.busy);
    });
  }

  // Other work with the program, to be awaited, that counts as well.
  async during(work) {
    this.others++;
    this.settle();
    try {
      return await work;
    } finally {
      this.others--;
      this.settle();
    }
  }
}
