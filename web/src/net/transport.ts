// SPDX-License-Identifier: Apache-2.0
// Fetches a character's files, whole or by ranges, by their names in the manifest, relative to the manifest's address
// after redirects. Keeps the whole file if a server ignores Range and sends it (200), and takes ranges from it.
import { keep } from '../page/promises.js';
import { ViewerError } from '../report/errors.js';
import { cannotLoad, isPartOfPage, originOf, PageFault, PassingFault, shortened, StatusFault } from './faults.js';
import { request, MAX_BYTES, patiently, type Answer, type Report } from './requests.js';

/** Returns the address that a file is fetched from, for example a presigned one. */
export type SignAddress = (url: string) => string | Promise<string>;

/** Options of all requests for a character. */
export interface RequestOptions {
  /** 'reload' bypasses the browser's cache, which may hold files of an earlier bake. */
  cache?: RequestCache;
  credentials?: RequestCredentials;
  /** Source of the `sign` callback, which is read at each request. */
  signer?: { readonly sign: SignAddress | null };
}

async function signedAddress(sign: SignAddress, url: string): Promise<string> {
  try {
    const address = await sign(url);
    if (!address) throw new TypeError('it gives no address');
    return new URL(address, globalThis.document?.baseURI).href;
  } catch (reason) {
    if (globalThis.navigator?.onLine === false) throw new PassingFault(originOf(url));
    throw cannotLoad(url, `the viewer's property sign fails (${String(reason)}); let it give the address that the file is fetched from`);
  }
}

const pathOf = (url: string): string => url.replace(/[?#].*/, '');

export class Transport {
  readonly #src: string;
  #base: string; // base URL of the names in the manifest
  readonly #report: Report;
  readonly #options: RequestOptions;
  readonly #signed = new Map<string, Promise<string>>(); // results of the page's `sign`, by address
  readonly #aliases = new Map<string, string>(); // absolute addresses, by the names that the player uses for them
  #early: Promise<{ url: string; bytes: Uint8Array }> | null = null; // start file, requested by a guessed name
  readonly #running = new Map<number, AbortController>();
  readonly #whole = new Map<string, Promise<Uint8Array>>();
  readonly #lengths = new Map<string, number>(); // file lengths from the manifest, bytes
  readonly #abort = new AbortController();
  // Ranges fetched so far, for a second player on another upload path; null: not kept.
  #replay: Map<string, Uint8Array> | null = new Map();

  /** report: called separately for each fetch. */
  constructor(manifestUrl: string, report: Report = () => undefined, options: RequestOptions = {}) {
    this.#src = this.#base = manifestUrl;
    this.#report = report;
    this.#options = options;
  }

  /** Fetches and parses the manifest. Errors: ViewerError 'fetch-failed', 'manifest-invalid'. */
  async manifest(): Promise<unknown> {
    const { signal } = this.#abort, src = this.#src;
    const bytes = await patiently(src, async () => {
      const answer = await this.#request(src, signal), bytes = await answer.read();
      this.#base = answer.redirectedTo || src;
      return bytes;
    }, this.#report, signal).catch((reason: unknown) => {
      throw reason instanceof PageFault ? this.#invalid('an HTML page, not JSON; src must name a character.gltf') : reason;
    });
    try {
      return JSON.parse(new TextDecoder().decode(bytes), (_, value) => this.#note(value)) as unknown;
    } catch (reason) {
      if (reason instanceof ViewerError) throw reason;
      const isGzip = bytes[0] === 0x1f && bytes[1] === 0x8b;
      throw this.#invalid(isGzip ? 'the file is compressed; let the server send Content-Encoding: gzip, or upload it as it was baked' : 'not JSON; src must name a character.gltf');
    }
  }

  /** Begins to fetch the start file, by a name derived from the manifest's address, before the manifest is read. */
  expectStart(): void {
    const url = this.#src.replace(/^(https?:[^?#]*)\.gltf(?=$|[?#])/, '$1.start.bin');
    if (url !== this.#src) this.#early = this.#fetchStart(url);
  }
  /** Fetches the start file that the manifest names; empty if the first attempt fails, since the file is optional. */
  async start(uri: string): Promise<Uint8Array> {
    const url = this.#locate(uri), early = await this.#early;
    const { bytes } = early && pathOf(early.url) === pathOf(url) ? early : await this.#fetchStart(url);
    return bytes;
  }
  async #fetchStart(url: string): Promise<{ url: string; bytes: Uint8Array }> {
    try {
      const answer = await this.#request(url, this.#abort.signal), bytes = await answer.read();
      return { url: answer.redirectedTo || url, bytes };
    } catch {
      return { url, bytes: new Uint8Array() };
    }
  }

  /** Address from which the browser can load a file of the manifest. Errors: ViewerError 'fetch-failed', 'manifest-invalid'. */
  async address(uri: string): Promise<string> { return this.#sign(this.#locate(uri)); }

  /** Fetches a range; null if it is cancelled. Errors: ViewerError 'fetch-failed'. */
  async range(id: number, uri: string, offset: number, bytes: number): Promise<Uint8Array | null> {
    const url = this.#locate(uri);
    const key = `${url}#${offset}+${bytes}`;
    const known = this.#replay?.get(key);
    if (known) return known;
    const abort = new AbortController();
    this.#running.set(id, abort);
    try {
      const part = await patiently(url, () => this.#fetchRange(url, offset, bytes, abort.signal), this.#report, abort.signal);
      this.#replay?.set(key, part);
      return part;
    } catch (reason) {
      if (abort.signal.aborted) return null;
      throw reason;
    } finally {
      if (this.#running.get(id) === abort) this.#running.delete(id);
    }
  }

  /** True while ranges are being fetched. */
  get busy(): boolean { return this.#running.size > 0; }

  cancel(id: number): void {
    this.#running.get(id)?.abort();
  }
  cancelAll(): void {
    for (const abort of this.#running.values()) abort.abort();
  }
  /** Drops the ranges kept for a second player: the upload path is settled. */
  stopReplay(): void {
    this.#replay = null;
  }
  dispose(): void {
    this.#abort.abort();
    this.cancelAll();
    this.#whole.clear();
    this.#replay = null;
  }

  #sign(url: string): Promise<string> {
    const sign = this.#options.signer?.sign;
    return sign ? keep(this.#signed, url, () => signedAddress(sign, url)) : this.#signed.get(url) ?? Promise.resolve(url);
  }

  // Requests a signed address; signs it again, once, if the server refuses it: signatures expire.
  async #request(url: string, signal: AbortSignal, headers: Record<string, string> = {}): Promise<Answer> {
    const { cache, credentials } = this.#options, signed = this.#sign(url);
    const send = async (address: string): Promise<Answer> => request({ url, address, init: { cache: cache!, credentials: credentials!, headers }, signal });
    return send(await signed).catch(async (reason: unknown) => {
      if (!(reason instanceof StatusFault) || this.#signed.get(url) !== signed) throw reason;
      this.#signed.delete(url);
      return send(await this.#sign(url));
    });
  }

  #invalid(problem: string): ViewerError { return new ViewerError('manifest-invalid', `${shortened(this.#base)}: ${problem}`); }

  // Resolves a file's name, and checks that it stays in the character's folder, as the manifest's reader has: a server may
  // unescape dots and slashes, and some URL parsers, such as that of Node 20, do not resolve every "..".
  #locate(uri: string): string {
    const alias = this.#aliases.get(uri);
    if (alias) return alias;
    try {
      const { href } = new URL(uri, this.#base), folder = new URL('.', this.#base).href;
      if (href.startsWith(folder) && !/\/\.\.|%(2e|2f|5c|25)/i.test(href.slice(folder.length - 1))) return href;
    } catch { /* not a URL */ }
    throw this.#invalid(`"${uri}" is not in the character's folder; bake it again`);
  }

  // Returns a name for an absolute address, which the player can use like a relative one.
  #nameFor(uri: string): string {
    let url: URL;
    try {
      url = new URL(uri);
    } catch {
      throw this.#invalid(`"${uri}" lies in no folder, because src is a ${new URL(this.#base).protocol} address; write whole addresses into the manifest, or let src be an https address`);
    }
    for (const [name, address] of this.#aliases) if (address === url.href) return name;
    const last = url.protocol === 'data:' ? 'data' : url.pathname.slice(-60).replace(/.*\/|[^\w.-]/g, '');
    const name = `${this.#aliases.size}-${last}`;
    this.#aliases.set(name, url.href);
    return name;
  }

  // Checks and renames the address in a value of the manifest that names a file; records the file's length.
  #note(value: { uri?: string; byteOffset?: number; byteLength?: number } | null): unknown {
    if (!value?.uri) return value;
    if (/^(blob|data):/.test(this.#base)) value.uri = this.#nameFor(value.uri);
    if (!/^data:/.test(value.uri)) {
      const url = this.#locate(value.uri);
      this.#lengths.set(url, Math.max(this.#lengths.get(url) ?? 0, (value.byteOffset ?? 0) + (value.byteLength ?? MAX_BYTES)));
    }
    return value;
  }

  async #fetchRange(url: string, offset: number, bytes: number, signal: AbortSignal): Promise<Uint8Array> {
    let whole = this.#whole.get(url);
    if (!whole) {
      const answer = await this.#request(url, signal, { Range: `bytes=${offset}-${offset + bytes - 1}` });
      if (answer.status === 206) return this.#readPart(answer, url, offset, bytes);
      // Reads only the first of several concurrent answers with the same file.
      if (this.#whole.has(url)) answer.drop();
      whole = keep(this.#whole, url, () => answer.read(this.#lengths.get(url)));
    }
    return slice(url, await whole, offset, bytes);
  }

  async #readPart(answer: Answer, url: string, offset: number, bytes: number): Promise<Uint8Array> {
    const [range, encoding, type] = ['Range', 'Encoding', 'Type'].map((name) => answer.headers.get(`Content-${name}`)); // null if another origin does not expose it
    if (range && !range.startsWith(`bytes ${offset}-`)) {
      answer.drop();
      throw cannotLoad(url, `the server answers with other bytes (${range}) than those from ${offset}; let it send the range that is requested, or the whole file`);
    }
    const part = await answer.read(this.#lengths.get(url));
    if (isPartOfPage(part, type!)) throw new PageFault(url);
    if (part.length !== bytes && encoding) {
      throw cannotLoad(url, `a range of a compressed file cannot be used (Content-Encoding: ${encoding}); serve .bin, .mp4 and pictures uncompressed`);
    }
    return slice(url, part, 0, bytes);
  }
}

function slice(url: string, from: Uint8Array, offset: number, bytes: number): Uint8Array {
  if (offset + bytes > from.length) {
    throw cannotLoad(url, `the file has less than ${offset + bytes} bytes; upload it again`);
  }
  return from.subarray(offset, offset + bytes);
}
