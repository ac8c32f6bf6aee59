// SPDX-License-Identifier: Apache-2.0
// One Chromium for all browser tests of a run; ctest starts it before the first and stops it after the last.
//   node browser.mjs start FILE   writes { address, pid } to FILE once tests can connect (harness.mjs: FOURDVT_BROWSER)
//   node browser.mjs stop FILE
import { spawn } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { dirname } from 'node:path';
import { fileURLToPath } from 'node:url';

import { launchServer } from './harness.mjs';

const kPatienceMs = 60_000;
const kLongestRunMs = 2 * 3600_000; // maximum run of tests, after which the browser ends by itself

function stop(file) {
  if (!existsSync(file)) return;
  const { pid } = JSON.parse(readFileSync(file, 'utf8'));
  rmSync(file);
  try { process.kill(pid, 'SIGTERM'); } catch { /* it has ended */ }
}

async function serve(file) {
  const browser = await launchServer();
  writeFileSync(`${file}.part`, JSON.stringify({ address: browser.wsEndpoint(), pid: process.pid }));
  renameSync(`${file}.part`, file);
  const end = () => browser.close().finally(() => process.exit(0));
  process.on('SIGTERM', end);
  setTimeout(end, kLongestRunMs);
}

async function start(file) {
  mkdirSync(dirname(file), { recursive: true });
  stop(file);
  const server = spawn(process.execPath, [fileURLToPath(import.meta.url), 'serve', file], { detached: true, stdio: 'ignore' });
  let ended = false;
  server.on('exit', () => { ended = true; });
  for (const end = Date.now() + kPatienceMs; !existsSync(file); await new Promise((next) => setTimeout(next, 50))) {
    if (ended || Date.now() > end) throw new Error('the browser does not start');
  }
  server.unref();
}

const [command, file] = process.argv.slice(2);
const commands = { start, stop, serve };
if (!commands[command] || !file) {
  console.error('usage: node browser.mjs start|stop FILE');
  process.exit(2);
}
await commands[command](file);
