// SPDX-License-Identifier: Apache-2.0
// A clock of the page that tests advance, to shorten waits: timers, performance.now, Date and the time of animation
// frames. Network, decoder and GPU stay real.
//   await page.addInitScript(installClock);  …  await page.evaluate((ms) => globalThis.testClock.turn(ms), 60_000);

/**
 * Runs in the page before its scripts. globalThis.testClock: turn(ms) adds time, in steps, with what the timers do in
 * between; setRate(rate) makes the clock run faster than the real one; now() in ms; requests(): what fetch was called for so
 * far, "address range".
 */
export function installClock() {
  const kStepMs = 250;     // half of the longest step that the frame loop catches up
  const kMinMs = 20;     // a step, however close the next timer is
  const kAnswerMs = 1000;  // real time that one step waits for the server's answers at most
  const real = {
    setTimeout: setTimeout.bind(globalThis), clearTimeout: clearTimeout.bind(globalThis), fetch: fetch.bind(globalThis),
    requestAnimationFrame: requestAnimationFrame.bind(globalThis), now: performance.now.bind(performance), Date,
  };
  let base = 0, since = 0, rate = 1, lastId = 0, unanswered = 0;
  const requests = [];
  const timers = new Map(); // by id: { due, period, run, native }
  const at = (realMs) => base + (realMs - since) * rate;
  const now = () => at(real.now());

  function arm(id, timer) {
    real.clearTimeout(timer.native);
    timer.native = real.setTimeout(() => fire(id, timer), (timer.due - now()) / rate);
  }
  function fire(id, timer) {
    if (timers.get(id) !== timer) return;
    if (timer.period === null) {
      stop(id);
    } else {
      timer.due = now() + timer.period;
      arm(id, timer);
    }
    timer.run();
  }
  const start = (repeats) => (run, ms = 0, ...values) => {
    const delay = Math.max(0, Number(ms) || 0), id = ++lastId;
    const timer = { due: now() + delay, period: repeats ? Math.max(1, delay) : null, run: () => run(...values), native: 0 };
    timers.set(id, timer);
    arm(id, timer);
    return id;
  };
  function stop(id) {
    real.clearTimeout(timers.get(id)?.native);
    timers.delete(id);
  }

  globalThis.setTimeout = start(false);
  globalThis.setInterval = start(true);
  globalThis.clearTimeout = globalThis.clearInterval = stop;
  globalThis.requestAnimationFrame = (callback) => real.requestAnimationFrame((ms) => callback(at(ms)));
  performance.now = now;
  const date = () => real.Date.now() + now() - real.now();
  globalThis.Date = class extends Date {
    constructor(...values) { super(...(values.length ? values : [date()])); }
    static now() { return date(); }
  };
  globalThis.fetch = (...request) => {
    requests.push(`${request[0]?.url ?? request[0]} ${new Headers(request[1]?.headers).get('Range') ?? ''}`);
    ++unanswered;
    return real.fetch(...request).finally(() => { --unanswered; });
  };

  // Requests that a timer has made are answered before the clock goes on.
  async function hearAnswers() {
    const begin = real.now();
    do await new Promise((next) => real.setTimeout(next, 1));
    while (unanswered && real.now() - begin < kAnswerMs);
  }
  // Steps end where the next timer is due, so that timers fire in their order.
  async function turn(ms) {
    for (let left = ms; left > 0;) {
      const next = Math.min(...[...timers.values()].map(({ due }) => due)) - now();
      const step = Math.min(left, Math.max(kMinMs, Math.min(kStepMs, next)));
      base += step;
      left -= step;
      const due = [...timers].filter(([, timer]) => timer.due <= now()).sort(([, a], [, b]) => a.due - b.due);
      for (const [id, timer] of due) fire(id, timer);
      await hearAnswers();
    }
    for (const [id, timer] of timers) arm(id, timer);
  }
  function setRate(wanted) {
    [base, since, rate] = [now(), real.now(), wanted];
    for (const [id, timer] of timers) arm(id, timer);
  }
  globalThis.testClock = { turn, setRate, now, requests: () => requests };
}
