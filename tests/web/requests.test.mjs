// SPDX-License-Identifier: Apache-2.0
// Requests of a character's files, against minimal servers: answers that are retried, and those that are errors at once,
// with cause and remedy; resolution of names after a redirect and in a manifest without a folder; signed addresses.
// Executed from source.
import assert from 'node:assert/strict';
import { createServer } from 'node:http';
import { afterEach, test } from 'node:test';
import { gzipSync } from 'node:zlib';

import { load } from './load_source.mjs';

const kPage = '<!DOCTYPE html><html><title>shop</title><div id="app"></div></html>'.padEnd(400);
const kBytes = Uint8Array.from({ length: 300 }, (_, i) => (i * 7) & 255);
const kManifest = { a: { uri: 'walk.bin', byteLength: 300 }, start: { uri: 'character.start.bin' } };
const later = globalThis.setTimeout;
globalThis.setTimeout = (call, ms, ...more) => later(call, ms / 100, ...more); // pauses between attempts are short

const servers = [];
afterEach(async () => {
  for (const server of servers.splice(0)) {
    server.closeAllConnections?.();
    await new Promise((done) => server.close(done));
  }
});

/** answer(path, response, request): path has the query. Gives the address, with a slash. */
async function serve(answer) {
  const requests = [];
  const server = createServer((request, response) => {
    requests.push(request.url);
    answer(request.url, response, request);
  });
  servers.push(server);
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  return { url: `http://127.0.0.1:${server.address().port}/`, requests };
}
const end = (response, status, body, headers = {}) => response.writeHead(status, headers).end(body);
const partOf = (request) => /bytes=(\d+)-(\d+)/.exec(request.headers.range).slice(1).map(Number);
const sendPart = (request, response, headers) => {
  const [first, last] = partOf(request);
  end(response, 206, kBytes.subarray(first, last + 1), headers);
};
const open = async (url, options) => new (await load('net/transport')).Transport(url, () => undefined, options);

test('statuses that pass are waited out, all others are errors at once that name the remedy', async () => {
  const { fetchFile } = await load('net/requests');
  const { url, requests } = await serve((path, response) => {
    const status = Number(path.slice(1)), isFirst = requests.filter((seen) => seen === path).length === 1;
    end(response, isFirst ? status : 200, 'abcd');
  });
  for (const status of [408, 425, 429, 500, 502, 503, 504, 520, 524]) {
    assert.equal((await fetchFile(`${url}${status}`)).length, 4, `${status} passes`);
  }
  for (const [status, remedy] of [[400, /configuration/], [401, /public.*sign/], [403, /public.*sign/], [404, /upload it/], [405, /configuration/],
    [410, /upload it/], [416, /shorter.*upload it again/], [451, /legal/], [501, /configuration/], [505, /configuration/]]) {
    await assert.rejects(fetchFile(`${url}${status}`), ({ id, message }) => id === 'fetch-failed' && message.includes(`/${status}: HTTP ${status}: `) && remedy.test(message), status);
    assert.equal(requests.filter((path) => path === `/${status}`).length, 1, `${status} is not tried again`);
  }
});

test('an HTML page in place of a file is named as such, and a file of any type is taken', async () => {
  const { url } = await serve((path, response, request) => {
    const html = { 'Content-Type': 'text/html; charset=utf-8' };
    if (path.includes('typed.bin')) return sendPart(request, response, html);
    if (path.includes('typed')) return end(response, 200, JSON.stringify(kManifest), html);
    if (path.includes('tail.bin')) return end(response, 206, kPage.slice(100, 200), html);
    end(response, 200, path.includes('feed') ? `\ufeff\n<?xml version="1.0"?>${kPage}` : kPage, path.includes('plain') ? {} : html);
  });
  for (const name of ['shop', 'plain', 'feed']) {
    await assert.rejects((await open(`${url}${name}.gltf`)).manifest(), { id: 'manifest-invalid', message: new RegExp(`/${name}\\.gltf: an HTML page.*src must name`) });
    await assert.rejects((await open(`${url}${name}.gltf`)).range(1, `${name}.bin`, 200, 100), { id: 'fetch-failed', message: /\.bin: the server sends an HTML page in place of the file; upload/ });
  }
  await assert.rejects((await open(`${url}x.gltf`)).range(1, 'tail.bin', 100, 100), { id: 'fetch-failed', message: /tail\.bin: the server sends an HTML page/ });
  const typed = await open(`${url}typed.gltf`);
  assert.deepEqual(await typed.manifest(), kManifest);
  assert.deepEqual(await typed.range(1, 'typed.bin', 100, 50), kBytes.subarray(100, 150));
});

test('a page in place of the player\'s wasm is named as such', async () => {
  const { compileFile } = await load('net/requests');
  const { url } = await serve((_, response) => end(response, 200, kPage, { 'Content-Type': 'text/html' }));
  await assert.rejects(compileFile(`${url}fourdvt-viewer.wasm`, () => undefined, 'default'), { id: 'fetch-failed', message: /viewer\.wasm: the server sends an HTML page/ });
});

test('answers that break off at the same byte each time, and ranges that are not what was requested, are errors', async () => {
  const { url, requests } = await serve((path, response, request) => {
    if (path === '/cut.bin') { // says more than it sends
      response.writeHead(206, { 'Content-Length': 100 });
      return response.write(kBytes.subarray(0, 30), () => response.destroy());
    }
    if (path === '/character.gltf') return end(response, 200, JSON.stringify(kManifest));
    if (path === '/walk.bin') { // another length than the file has
      response.writeHead(200, { 'Content-Length': 310 });
      return response.write(kBytes, () => response.destroy());
    }
    if (path === '/flaky.bin' && requests.length < 6) { // another length each time
      response.writeHead(206, { 'Content-Length': 100 });
      return response.write(kBytes.subarray(0, 10 * requests.length), () => response.destroy());
    }
    if (path === '/packed.bin') return end(response, 206, gzipSync(kBytes.subarray(0, 20)), { 'Content-Encoding': 'gzip' });
    if (path === '/not-packed.bin') return end(response, 206, kBytes.subarray(0, 100), { 'Content-Encoding': 'gzip' });
    if (path === '/other.bin') return end(response, 206, kBytes.subarray(0, 100), { 'Content-Range': 'bytes 0-99/300' });
    if (path === '/short.bin') return end(response, 206, kBytes.subarray(0, 20));
    sendPart(request, response);
  });
  const failure = async (name) => {
    requests.length = 0;
    return (await open(`${url}character.gltf`)).range(1, name, 0, 100).then(() => 'came', ({ id, message }) => (assert.equal(id, 'fetch-failed'), message));
  };
  const long = await open(`${url}character.gltf`);
  await long.manifest();
  await assert.rejects(long.range(1, 'walk.bin', 0, 100), { id: 'fetch-failed', message: /more than 300 bytes; upload the file again/ });
  assert.match(await failure('cut.bin'), /breaks off after 30 bytes each time; .*Content-Length/);
  assert.equal(requests.length, 4);
  assert.equal(await failure('flaky.bin'), 'came');
  assert.match(await failure('not-packed.bin'), /breaks off after 0 bytes each time; .*Content-Encoding/);
  assert.match(await failure('packed.bin'), /compressed file cannot be used \(Content-Encoding: gzip\); serve .*uncompressed/);
  assert.match(await failure('short.bin'), /less than 100 bytes; upload it again/);
  await assert.rejects((await open(`${url}character.gltf`)).range(1, 'other.bin', 100, 100), { id: 'fetch-failed', message: /other bytes \(bytes 0-99\/300\) than those from 100; let it send/ });
});

test('a manifest that is compressed without saying so is one clear error', async () => {
  const { url } = await serve((_, response) => end(response, 200, Buffer.from('1f8b0800000000000003', 'hex')));
  await assert.rejects((await open(`${url}character.gltf`)).manifest(), { id: 'manifest-invalid', message: /compressed; .*Content-Encoding: gzip/ });
});

test('names lead into the folder of the address that answered with the manifest', async () => {
  const { url, requests } = await serve((path, response, request) => {
    const to = { '/latest/character.gltf': '/v7/character.gltf?signed=1', '/every/character.gltf': '/v7/character.gltf', '/every/character.start.bin': '/v7/character.start.bin' }[path];
    if (to) return end(response, 302, '', { Location: to });
    if (path.startsWith('/v7/character.gltf')) return end(response, 200, JSON.stringify(kManifest));
    if (path.startsWith('/v7/character.start.bin')) return end(response, 200, 'start');
    if (path === '/v7/walk.bin') return sendPart(request, response);
    end(response, 404, '');
  });
  for (const src of ['latest', 'every', 'v7']) {
    requests.length = 0;
    const transport = await open(`${url}${src}/character.gltf${src === 'v7' ? '?query=a%20b.gltf' : ''}`);
    transport.expectStart();
    await transport.manifest();
    assert.equal(new TextDecoder().decode(await transport.start('character.start.bin')), 'start', src);
    assert.deepEqual(await transport.range(1, 'walk.bin', 100, 50), kBytes.subarray(100, 150));
    assert.equal(await transport.address('walk.bin'), `${url}v7/walk.bin`);
    assert.equal(requests.filter((path) => path.startsWith('/v7/character.start.bin')).length, 1, `${src}: the start file comes once`);
    await assert.rejects(transport.range(2, '../latest/x.bin', 0, 4), { id: 'manifest-invalid' });
    transport.dispose();
  }
});

test('a manifest without a folder: whole addresses play, names are refused with the remedy', async () => {
  const { url, requests } = await serve((path, response, request) => sendPart(request, response));
  const data = `data:application/octet-stream;base64,${Buffer.from(kBytes).toString('base64')}`;
  const whole = { a: { uri: `${url}x/walk.bin?token=1`, byteLength: 300 }, b: { uri: data, byteLength: 300 }, again: { uri: data }, start: { uri: `${url}character.start.bin` } };
  const blob = URL.createObjectURL(new Blob([JSON.stringify(whole)]));
  for (const src of [`data:model/gltf+json,${encodeURIComponent(JSON.stringify(whole))}`, blob]) {
    requests.length = 0;
    const transport = await open(src);
    transport.expectStart();
    assert.deepEqual(requests, [], 'no name can be guessed');
    const { a, b, again, start } = await transport.manifest();
    for (const { uri } of [a, b, start]) assert.match(uri, /^[\w.-]{1,80}$/, 'the player gets plain names');
    assert.equal(again.uri, b.uri);
    for (const { uri } of [a, b]) assert.deepEqual(await transport.range(1, uri, 100, 50), kBytes.subarray(100, 150));
    assert.deepEqual(requests, ['/x/walk.bin?token=1']);
    assert.equal(await transport.address(a.uri), `${url}x/walk.bin?token=1`);
    transport.dispose();
  }
  const bare = `data:model/gltf+json,${encodeURIComponent(JSON.stringify(kManifest))}`;
  await assert.rejects((await open(bare)).manifest(), ({ id, message }) => id === 'manifest-invalid' && message.length < 300 && /"walk\.bin" lies in no folder, because src is a data: address; write whole addresses/.test(message));
  await assert.rejects((await open('data:text/plain,hello')).manifest(), { id: 'manifest-invalid', message: /not JSON/ });
});

test('the page signs every file once, and again where the server refuses a signature', async () => {
  let valid = 1;
  const { url, requests } = await serve((path, response, request) => {
    if (!path.endsWith(`?sig=${valid}`)) return end(response, 403, 'AccessDenied');
    if (path.includes('.gltf')) return end(response, 200, JSON.stringify(kManifest));
    if (path.includes('start')) return end(response, 200, 'start');
    sendPart(request, response);
  });
  const signed = [];
  const signer = { sign: async (file) => (signed.push(file), `${file}?sig=${valid}`) };
  const transport = await open(`${url}character.gltf`, { signer });
  transport.expectStart();
  await transport.manifest();
  assert.equal((await transport.start('character.start.bin')).length, 5);
  for (const offset of [0, 50, 100]) assert.deepEqual(await transport.range(offset, 'walk.bin', offset, 50), kBytes.subarray(offset, offset + 50));
  assert.deepEqual(signed.sort(), [`${url}character.gltf`, `${url}character.start.bin`, `${url}walk.bin`]);
  valid = 2; // what was signed has expired
  assert.deepEqual(await transport.range(7, 'walk.bin', 150, 50), kBytes.subarray(150, 200));
  assert.equal(signed.length, 4);
  assert.equal(await transport.address('walk.bin'), `${url}walk.bin?sig=2`);
  signer.sign = (file) => `${file}?sig=wrong`;
  requests.length = 0;
  const refused = await open(`${url}character.gltf`, { signer });
  await assert.rejects(refused.range(1, 'walk.bin', 0, 4), ({ id, message }) => id === 'fetch-failed' && /walk\.bin: HTTP 403: /.test(message) && !message.includes('sig='));
  assert.equal(requests.length, 2, 'signed anew once');
  for (const sign of [() => { throw new Error('no session'); }, async () => { throw new Error('no session'); }, () => undefined, () => 'http://[']) {
    await assert.rejects((await open(`${url}character.gltf`, { signer: { sign } })).manifest(), { id: 'fetch-failed', message: /character\.gltf: the viewer's property sign fails \(.+\); let it give/ });
  }
});

test('a server that refuses cookies, or the page, is distinguished from one that is away; the headers are named', async () => {
  const { fetchFile } = await load('net/requests?cors');
  const real = globalThis.fetch;
  // A browser that hides the answer: only a request that reads nothing succeeds.
  globalThis.fetch = async (_, { mode }) => {
    if (mode === 'no-cors') return new Response('');
    throw new TypeError('Failed to fetch');
  };
  globalThis.origin = 'https://page.example';
  try {
    await assert.rejects(fetchFile('https://cdn.example/x.bin', undefined, undefined, { credentials: 'include' }),
      { id: 'fetch-failed', message: /Access-Control-Allow-Origin: https:\/\/page\.example \(\* does not do.*use-credentials.*\) and Access-Control-Allow-Credentials: true/ });
    await assert.rejects(fetchFile('https://cdn.example/x.bin'), { id: 'fetch-failed', message: /let it send Access-Control-Allow-Origin, and allow the header Range/ });
  } finally {
    globalThis.fetch = real;
    delete globalThis.origin;
  }
});

test('ranges that the browser refuses, compressed ones for example, are distinguished from a lost network', async () => {
  const { Transport } = await load('net/transport?ranges');
  const real = globalThis.fetch;
  globalThis.fetch = async (_, { headers }) => {
    if (headers?.Range) throw new TypeError('Failed to fetch');
    return new Response('whole');
  };
  globalThis.origin = 'https://page.example';
  try {
    await assert.rejects(new Transport('https://page.example/x.gltf').range(1, 'x.bin', 0, 4), { id: 'fetch-failed', message: /x\.bin: the browser refuses parts .*without Content-Encoding$/ });
    await assert.rejects(new Transport('https://cdn.example/x.gltf').range(1, 'x.bin', 0, 4), { id: 'fetch-failed', message: /without Content-Encoding, and allow the header Range/ });
  } finally {
    globalThis.fetch = real;
    delete globalThis.origin;
  }
});

test('an address of the page\'s own server that redirects to a server that is never there is given up, too', async () => {
  const { fetchFile } = await load('net/requests?redirects');
  const real = globalThis.fetch;
  globalThis.fetch = async (_, { redirect }) => {
    if (redirect === 'manual') return Object.defineProperty(new Response(''), 'type', { value: 'opaqueredirect' });
    throw new TypeError('Failed to fetch');
  };
  globalThis.origin = 'https://page.example';
  try {
    await assert.rejects(fetchFile('https://page.example/latest.gltf'), { id: 'fetch-failed', message: /latest\.gltf: the address that it redirects to has never answered/ });
  } finally {
    globalThis.fetch = real;
    delete globalThis.origin;
  }
});
