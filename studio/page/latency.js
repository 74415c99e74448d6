// How long an optimum lags behind the hand: from the time that the browser gives a pointer's event to
// the end of the frame in which an optimum is drawn that knows of it.

import { median } from './numbers.js';

const most_kept = 2000;
const most_shown = 60;

export class Latency {
  constructor() {
    this.all = []; // of every move [ms]
    this.moves = []; // times of moves that no drawn optimum knows of
    this.answered = null; // the latest move that the answer at hand knows of
    this.frame_end = new MessageChannel();
    this.frame_end.port1.onmessage = ({ data }) => this.record(data);
  }

  move(time) { this.moves.push(time); }
  get latest() { return this.moves.at(-1) ?? null; }

  forget() {
    this.moves = [];
    this.answered = null;
  }

  // An answer that knows of every move until `move` is going to be drawn.
  answer(move) { this.answered = move ?? this.answered; }

  // Called in the frame that draws. A message comes after it, once it is laid out and painted.
  drawn() {
    if (this.answered === null) return;
    this.frame_end.port2.postMessage(this.answered);
    this.answered = null;
  }

  record(until) {
    const end = performance.now();
    this.all.push(...this.moves.filter((time) => time <= until).map((time) => end - time));
    this.all.splice(0, this.all.length - most_kept);
    this.moves = this.moves.filter((time) => time > until);
  }

  get median() { return this.all.length ? median(this.all.slice(-most_shown)) : null; }
}
