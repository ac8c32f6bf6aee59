// SPDX-License-Identifier: Apache-2.0
// Processes of a live system (a server, cameras), a slow or breaking connection between them, and the processes' CPU
// time and memory.
import { spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { createServer, connect } from 'node:net';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const kRoot = fileURLToPath(new URL('../../..', import.meta.url));
export const kTool = process.env.FOURDVT_BIN ?? join(kRoot, 'build/release/native/tools/fourdvt');
export const kSite = process.env.FOURDVT_SITE ?? join(kRoot, 'build/site');
const kPatienceMs = 20_000;
const kTicksPerSecond = 100; // USER_HZ, the same on all Linux machines

export const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** True as soon as `check` (which may be async) is; false after `patienceMs`. */
export async function until(check, patienceMs = kPatienceMs, everyMs = 20) {
  for (const end = Date.now() + patienceMs; Date.now() < end; await pause(everyMs)) if (await check()) return true;
  return false;
}

class Program {
  constructor(words, environment = {}) {
    this.text = '';
    this.startedMs = Date.now();
    this.process = spawn(kTool, words, { stdio: ['ignore', 'pipe', 'pipe'], env: { ...process.env, ...environment } });
    for (const stream of [this.process.stdout, this.process.stderr]) stream.on('data', (part) => (this.text = (this.text + part).slice(-20_000)));
    this.ended = new Promise((done) => this.process.on('exit', done));
  }
  get pid() { return this.process.pid; }
  async stop(signal = 'SIGINT') {
    this.process.kill(signal);
    return this.ended;
  }
}

/** `fourdvt live` of a stage, with tokens and without reading cameras itself. */
export class LiveServer extends Program {
  constructor(stage, { port = 0, options = [] } = {}) {
    const tokens = join(stage, 'tokens');
    super(['live', join(stage, 'RIG.json'), '--port', String(port), '--no-local', '--web', kSite, '--tokens', tokens, ...options]);
    this.stage = stage;
    this.tokensFile = tokens;
  }
  async listening() {
    if (!await until(() => /https?:\/\/[^\s:]+:(\d+)/.test(this.text) || this.process.exitCode !== null)) throw new Error('fourdvt live does not start');
    if (this.process.exitCode !== null) throw new Error(`fourdvt live: ${this.text}`);
    this.port = Number(/https?:\/\/[^\s:]+:(\d+)/.exec(this.text)[1]);
    return this;
  }
  token(role) { return new RegExp(`^${role}\\s+(\\S+)`, 'm').exec(readFileSync(this.tokensFile, 'utf8'))[1]; }
  get url() { return `http://localhost:${this.port}`; }
  get viewerAddress() { return `ws://localhost:${this.port}/live?token=${this.token('viewer')}`; }
  async status() {
    const answer = await fetch(`http://127.0.0.1:${this.port}/status.json`, { headers: { Authorization: `Bearer ${this.token('console')}`, Host: `localhost:${this.port}` } });
    return answer.json();
  }
}

/** `fourdvt live-camera`: one process per camera. */
export class LiveCamera extends Program {
  constructor(server, name, { options = [], port = server.port } = {}) {
    super(['live-camera', join(server.stage, 'RIG.json'), name, '--server', `ws://127.0.0.1:${port}`, ...options], { FOURDVT_LIVE_TOKEN: server.token('camera') });
    this.name = name;
  }
}

/** Records a live system's state every `everyMs` until stop(), which returns the list of {ms, status}. */
export function watch(server, everyMs) {
  const seen = [];
  let stopped = false;
  const done = (async () => {
    for (; !stopped; await pause(everyMs)) {
      const status = await server.status().catch(() => null); // null while it is down
      if (status) seen.push({ ms: Date.now(), status });
    }
  })();
  return { seen, async stop() { stopped = true; await done; return seen; } };
}

/** Proxy between a client and a server, with a limited rate and piece size, until it is cut. */
export class Link {
  constructor(port, { bytesPerSecond = Infinity, pieceBytes = Infinity } = {}) {
    this.cuts = 0;
    this.sockets = new Set();
    this.cutAfter = Infinity; // remaining bytes from the client
    this.server = createServer((client) => {
      const there = connect({ port, host: '127.0.0.1', noDelay: true });
      client.setNoDelay(true);
      for (const socket of [client, there]) {
        this.sockets.add(socket);
        socket.on('error', () => undefined);
        socket.on('close', () => { this.sockets.delete(socket); client.destroy(); there.destroy(); });
      }
      client.on('data', (data) => this.#fromClient(data, client, there, pieceBytes));
      if (bytesPerSecond === Infinity) there.pipe(client);
      else this.#slowly(there, client, bytesPerSecond);
    });
  }
  async listen() {
    await new Promise((done) => this.server.listen(0, '127.0.0.1', done));
    this.port = this.server.address().port;
    return this;
  }
  #fromClient(data, client, there, pieceBytes) {
    const whole = Math.min(data.length, this.cutAfter);
    for (let at = 0; at < whole; at += pieceBytes) there.write(data.subarray(at, Math.min(whole, at + pieceBytes)));
    this.cutAfter -= whole;
    if (this.cutAfter > 0) return;
    this.cutAfter = Infinity;
    this.cuts += 1;
    this.cutMs = Date.now();
    client.destroy();
    there.end(); // sends pending data first
  }
  #slowly(from, to, bytesPerSecond) {
    const kStepMs = 10, most = Math.max(1, Math.round(bytesPerSecond * kStepMs / 1000));
    from.pause();
    const timer = setInterval(() => {
      const data = from.read(Math.min(most, from.readableLength)) ?? null;
      if (data) to.write(data);
    }, kStepMs);
    from.on('close', () => clearInterval(timer));
  }
  async close() {
    for (const socket of this.sockets) socket.destroy();
    await new Promise((done) => this.server.close(done));
  }
}

/** CPU seconds so far of a process and its descendants. */
export function cpuSeconds(pid) {
  const fields = statOf(pid);
  return fields ? (Number(fields[11]) + Number(fields[12]) + Number(fields[13]) + Number(fields[14])) / kTicksPerSecond : 0;
}

function statOf(pid) {
  try {
    return readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ').at(-1).split(' ');
  } catch {
    return null;
  }
}

/** Resident bytes of a process; NaN if it has ended. */
export function residentBytes(pid) {
  try {
    return Number(/VmRSS:\s+(\d+) kB/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) * 1024;
  } catch {
    return NaN;
  }
}
