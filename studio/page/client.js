// Requests to the program that serves the page, see API.md.

const page_id = Math.random().toString(36).slice(2, 10);

class Refused extends Error {
  constructor(status, message) {
    super(message);
    this.status = status;
  }
}

// `signal` ends the wait for the answer.
export async function ask(path, parameters, body, signal) {
  const query = new URLSearchParams(parameters).toString();
  let response;
  try {
    response = await fetch(`/api/${path}${query && `?${query}`}`, {
      method: 'POST', headers: { 'Content-Type': 'application/json' }, body, signal,
    });
  } catch {
    throw new Refused(0, 'The program behind this page has ended. Start “nuno studio” again: the scene is kept.');
  }
  if (!response.ok) {
    const answer = await response.json().catch(() => ({}));
    throw new Refused(response.status, answer.error ?? `The studio answered with ${response.status}.`);
  }
  return response;
}

// How much is made of a page's film or report, 0 … 1.
export async function share_made(page) {
  const response = await fetch(`/api/progress?page=${page}`);
  return response.ok ? (await response.json()).progress : 0;
}

// One kind of work: at most one request under way and one that waits; the newest wins. An urgent one
// does not wait: it takes the place of the one under way, whose work the program gives up.
export class Channel {
  // `idle` is called whenever work has ended.
  constructor(name, idle) {
    this.page = `${page_id}-${name}`;
    this.idle = idle;
    this.running = 0;
    this.newest = 0;
    this.waiting = null;
    this.dropping = new AbortController();
  }

  get busy() { return this.running > 0 || this.waiting !== null; }

  // `work(page, signal)` is async; `done(result)` and `failed(error)` are called for what is not
  // overtaken by then.
  run({ work, done, failed, urgent }) {
    const job = { work, done, failed, number: ++this.newest, signal: this.dropping.signal };
    if (this.running > 0 && !urgent) {
      this.waiting = job;
      return;
    }
    this.waiting = null;
    this.start(job);
  }

  // Nothing that was asked for until now is wanted any more.
  drop() {
    this.waiting = null;
    this.dropping.abort();
    this.dropping = new AbortController();
  }

  async start(job) {
    this.running++;
    let again = false;
    try {
      const result = await job.work(this.page, job.signal);
      if (!this.overtaken(job)) job.done(result);
    } catch (error) {
      // The newest gives way to nothing: an older request came later to the program than it did.
      again = error?.status === 409 && job.number === this.newest && !job.signal.aborted;
      if (error?.status !== 409 && !this.overtaken(job)) job.failed(error);
    } finally {
      this.running--;
      if (again) {
        this.start(job);
      } else if (this.running === 0 && this.waiting) {
        const next = this.waiting;
        this.waiting = null;
        this.start(next);
      }
      this.idle();
    }
  }

  // It is dropped, a later answer is drawn already or an urgent job is on its way; one that only
  // waits does not make an answer stale: while the pointer moves, there is always one that waits.
  overtaken(job) {
    return job.signal.aborted || (this.newest !== job.number && this.waiting?.number !== this.newest);
  }
}
