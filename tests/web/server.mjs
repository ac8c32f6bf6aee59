// SPDX-License-Identifier: Apache-2.0
// Static files with byte ranges, for tests and the demo. Not a public web server: one folder, GET and HEAD only.
//   import { serve } from './server.mjs';  const { url, close, requests } = await serve(folder);
//   node server.mjs FOLDER [PORT]          takes the next free port, prints the address
//   node server.mjs FOLDER PORT KEY CERT   https for the local network; prints an address that other devices reach
import { createReadStream, readFileSync } from 'node:fs';
import { stat } from 'node:fs/promises';
import { createServer } from 'node:http';
import { createServer as createSecureServer } from 'node:https';
import { networkInterfaces } from 'node:os';
import { extname, join, resolve, sep } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const kPackable = new Set(['.html', '.css', '.js', '.json', '.gltf', '.wasm', '.svg']);
const TYPES = {
  '.html': 'text/html; charset=utf-8', '.css': 'text/css; charset=utf-8', '.js': 'text/javascript; charset=utf-8',
  '.mjs': 'text/javascript; charset=utf-8', '.json': 'application/json', '.gltf': 'model/gltf+json',
  '.wasm': 'application/wasm', '.mp4': 'video/mp4', '.bin': 'application/octet-stream', '.webp': 'image/webp',
  '.png': 'image/png', '.jpg': 'image/jpeg', '.svg': 'image/svg+xml', '.ico': 'image/x-icon',
  '.woff2': 'font/woff2', '.txt': 'text/plain; charset=utf-8', '.md': 'text/plain; charset=utf-8',
};

// The file a request path names, or null outside the root.
function locate(root, requestUrl) {
  let path;
  try {
    path = decodeURIComponent(new URL(requestUrl, 'http://x').pathname);
  } catch {
    return null;
  }
  const file = resolve(join(root, path));
  return (file === root || file.startsWith(root + sep)) && !path.includes('\0') ? file : null;
}

// [first, last] of a single satisfiable range, 'none' without one, 'bad' if it cannot be satisfied.
function parseRange(header, size) {
  const match = /^bytes=(\d*)-(\d*)$/.exec(header ?? '');
  if (!match || (match[1] === '' && match[2] === '')) return 'none';
  const first = match[1] === '' ? Math.max(0, size - Number(match[2])) : Number(match[1]);
  const last = match[1] === '' || match[2] === '' ? size - 1 : Math.min(Number(match[2]), size - 1);
  return first > last || first >= size ? 'bad' : [first, last];
}

// The file to answer with, in the first of the folders that has it; else null. redirect: a folder's path lacks its slash.
async function find(folders, requestUrl) {
  for (const folder of folders) {
    let file = locate(folder, requestUrl), info = file ? await stat(file).catch(() => null) : null;
    if (info?.isDirectory()) {
      if (!new URL(requestUrl, 'http://x').pathname.endsWith('/')) return { redirect: true };
      file = join(file, 'index.html');
      info = await stat(file).catch(() => null);
    }
    if (info?.isFile()) return { file, info };
  }
  return null;
}

async function answer(folders, options, request, response, entry) {
  if (options.handle?.(request, response)) return;
  const finish = (status, headers = {}, body = '') => {
    entry.status = status;
    response.writeHead(status, { 'Content-Length': Buffer.byteLength(body), ...headers });
    response.end(request.method === 'HEAD' ? undefined : body);
  };
  if (request.method !== 'GET' && request.method !== 'HEAD') return finish(405, { Allow: 'GET, HEAD' });
  const page = options.pages?.[request.url];
  if (page) return finish(200, { 'Content-Type': TYPES['.html'], ...page.headers }, page.html);
  const fault = options.misbehave?.(request) ?? {};
  if (fault.away) return request.socket.destroy();
  if (fault.status) return finish(fault.status, { 'Cache-Control': 'no-store' });
  if (fault.text !== undefined) return finish(200, { 'Cache-Control': 'no-store' }, fault.text);
  const found = await find(folders, fault.url ?? request.url);
  if (!found) return finish(404, { 'Content-Type': 'text/plain' }, 'not found\n');
  if (found.redirect) {
    const url = new URL(request.url, 'http://x');
    return finish(301, { Location: `${url.pathname}/${url.search}` });
  }
  const { file, info } = found;
  if (options.edit && extname(file) === '.html') {
    return finish(200, { 'Content-Type': TYPES['.html'], 'Cache-Control': 'no-store' }, options.edit(readFileSync(file, 'utf8')));
  }
  const headers = {
    'Content-Type': TYPES[extname(file).toLowerCase()] ?? 'application/octet-stream',
    'Cache-Control': 'no-cache', 'Last-Modified': info.mtime.toUTCString(), ...options.headers,
  };
  const ranges = options.ranges !== false && !fault.whole, size = Math.min(info.size, fault.truncate ?? info.size);
  if (ranges) headers['Accept-Ranges'] = 'bytes';
  const range = ranges ? parseRange(request.headers.range, size) : 'none';
  if (range === 'bad') return finish(416, { 'Content-Range': `bytes */${size}` });
  const [first, last] = range === 'none' ? [0, size - 1] : range;
  if (range !== 'none') headers['Content-Range'] = `bytes ${first}-${last}/${size}`;
  const packed = options.gzip && range === 'none' && kPackable.has(extname(file)) ? gzipSync(readFileSync(file), { level: 9 }) : null;
  if (packed) headers['Content-Encoding'] = 'gzip';
  headers['Content-Length'] = packed?.length ?? last - first + 1;
  entry.status = range === 'none' ? 200 : 206;
  entry.bytes = last - first + 1;
  response.writeHead(entry.status, headers);
  if (request.method === 'HEAD' || size === 0) return response.end();
  if (packed) return response.end(packed);
  if (fault.spoil) return response.end(readFileSync(file).subarray(first, last + 1).map((byte) => byte ^ 0x55));
  if (fault.stallAfter !== undefined) return response.write(readFileSync(file).subarray(first, Math.min(first + fault.stallAfter, last + 1)));
  const stream = createReadStream(file, { start: first, end: last, highWaterMark: fault.bytesPerS ? fault.bytesPerS / 10 : undefined });
  stream.on('error', () => response.destroy());
  response.on('close', () => stream.destroy());
  if (!fault.bytesPerS) return stream.pipe(response);
  for await (const part of stream) {
    response.write(part);
    await new Promise((next) => setTimeout(next, 100));
  }
  response.end();
}

/**
 * Serves `root` on 127.0.0.1. options: ranges (false: answer 200 to range requests), headers (added to every file), host,
 * pages (by path: { html, headers }, beside those of the folder), tls ({ key, cert }: https), misbehave(request): what
 * goes wrong with this request, if anything: { away: true } (the connection breaks), { status }, { text } (this instead of
 * the file), { url } (another file), { truncate: bytes } (the file ends there), { spoil: true } (wrong bytes), { whole: true }
 * (200 for a range), { stallAfter: bytes } (no more bytes follow, and no end), { bytesPerS }; forgets (true: keep no
 * requests); gzip (true: texts and wasm are sent compressed); over (a folder whose files come before those of `root`), edit(html)
 * (the page to send instead), handle(request, response) (true: it answers). `requests` grows by { method, path, range, status, bytes } for every request.
 */
export function serve(root, port = 0, options = {}) {
  const folders = [options.over, root].filter(Boolean).map((folder) => resolve(folder));
  const requests = [];
  const create = options.tls ? (listener) => createSecureServer(options.tls, listener) : createServer;
  const server = create((request, response) => {
    const entry = { method: request.method, path: request.url, range: request.headers.range ?? null, status: 0, bytes: 0 };
    if (!options.forgets) requests.push(entry);
    answer(folders, options, request, response, entry).catch(() => response.destroy());
  });
  return new Promise((done, fail) => {
    server.once('error', fail);
    server.listen(port, options.host ?? '127.0.0.1', () => {
      const close = () => new Promise((closed) => {
        server.close(closed);
        server.closeAllConnections?.();
      });
      const { port: taken } = server.address();
      done({ url: options.tls ? `https://${addressInNetwork()}:${taken}/` : `http://127.0.0.1:${taken}/`, close, requests });
    });
  });
}

// The first address under which other devices of the local network reach this machine.
function addressInNetwork() {
  const all = Object.values(networkInterfaces()).flat();
  return all.find((entry) => entry.family === 'IPv4' && !entry.internal)?.address ?? '127.0.0.1';
}

/** For the demo, which may run for days: `requests` stays empty. */
export async function serveOnNextFreePort(root, wanted, options) {
  for (let port = wanted; port < wanted + 100; ++port) {
    try {
      return await serve(root, port, { ...options, forgets: true });
    } catch (reason) {
      if (reason.code !== 'EADDRINUSE' && reason.code !== 'EACCES') throw reason;
    }
  }
  throw new Error(`no free port from ${wanted} to ${wanted + 99}: name another one`);
}

if (process.argv[1] && resolve(process.argv[1]) === fileURLToPath(import.meta.url)) {
  const [root, port = '8080', key, cert] = process.argv.slice(2);
  if (!root || !(Number(port) >= 0)) {
    console.error('usage: node server.mjs FOLDER [PORT [KEY CERT]]');
    process.exit(2);
  }
  if (!(await stat(root).catch(() => null))?.isDirectory()) {
    console.error(`server.mjs: ${root} is not a folder`);
    process.exit(2);
  }
  const options = cert ? { host: '0.0.0.0', tls: { key: readFileSync(key), cert: readFileSync(cert) } } : {};
  const { url } = await serveOnNextFreePort(root, Number(port), options);
  console.log(url);
}
