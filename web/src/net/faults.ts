// SPDX-License-Identifier: Apache-2.0
// Faults of a request: transient ones, which are retried, and permanent ones, errors with cause and remedy.
import { ViewerError } from '../report/errors.js';

export const originOf = (address: string): string => parse(address).origin;
const parse = (address: string): URL => new URL(address, globalThis.document?.baseURI);

/** Shortens a data: address for messages. */
export const shortened = (url: string): string => (url.startsWith('data:') ? `${url.slice(0, 40)}…` : url);
export const cannotLoad = (url: string, why: string): ViewerError => new ViewerError('fetch-failed', `${shortened(url)}: ${why}`);

/** Transient fault: another attempt may succeed. */
export class PassingFault extends Error {
  /** Origin that has not answered, or has answered with a transient status. */
  readonly origin: string;
  /** Minimum pause before the next attempt, ms. */
  readonly pauseMs: number;
  /** Bytes received before the answer broke off; NaN if it did not. */
  readonly brokeAtBytes: number;
  constructor(origin: string, { pauseMs = 0, brokeAtBytes = NaN } = {}) {
    super();
    this.origin = origin;
    this.pauseMs = pauseMs;
    this.brokeAtBytes = brokeAtBytes;
  }
}

const LASTING_5XX = [501, 505, 506, 508, 510]; // caused by the server's software or configuration: permanent

/** Returns true for a transient status. */
export const passes = (status: number): boolean => [408, 425, 429].includes(status) || (status >= 500 && !LASTING_5XX.includes(status));

function remedyOf(status: number): string {
  if (status === 401 || status === 403) return "the server refuses it to this page; make the file public, or give the character's files signed addresses by the viewer's property sign";
  if (status === 404 || status === 410) return 'the server has no such file; upload it, or correct the address';
  if (status === 416) return 'the file on the server is shorter than its manifest says; upload it again';
  if (status === 451) return 'the server withholds it for legal reasons; offer it from elsewhere';
  return 'the server does not serve it to a plain GET; correct its configuration';
}

/** Permanent status. */
export class StatusFault extends ViewerError {
  constructor(url: string, status: number) {
    super('fetch-failed', `${shortened(url)}: HTTP ${status}: ${remedyOf(status)}`);
  }
}

/** HTML page in place of the file. */
export class PageFault extends ViewerError {
  constructor(url: string) {
    super('fetch-failed', `${shortened(url)}: the server sends an HTML page in place of the file; upload the file, and let the server answer 404 where there is none`);
  }
}

const beginning = (bytes: Uint8Array): string => String.fromCharCode(...bytes.subarray(0, 100));
const isText = (text: string): boolean => !/[\0-\x08\x0e-\x1f]/.test(text);

/** Returns true if the bytes begin like an HTML or XML page, as no file of a character or of the player does. */
export function isPage(bytes: Uint8Array): boolean {
  const text = beginning(bytes);
  return isText(text) && /^(\xef\xbb\xbf)?\s*<[!?a-z]/i.test(text);
}
/** Returns true if a range is part of a page: type text/html, and none of the control characters of binary files. */
export const isPartOfPage = (bytes: Uint8Array, type: string | null): boolean => /^text\/html/.test(type ?? '') && bytes.length >= 100 && isText(beginning(bytes));

// Addresses that the page's policy blocks, as the browser reports them.
const blocked = new Set<string>();
globalThis.addEventListener?.('securitypolicyviolation', (e) => {
  if (e.disposition === 'enforce') blocked.add(e.blockedURI);
});

/** Reason for which the browser refuses any request to the address; empty if there is none. */
export function refusalOf(address: string): string {
  const { protocol, username, hostname, href, hash } = parse(address), isWeb = /^https?:$/.test(protocol);
  if (blocked.has(isWeb ? href.slice(0, href.length - hash.length) : protocol.slice(0, -1))) {
    return `the page's content-security policy blocks it; add ${isWeb ? 'its origin' : protocol} to connect-src`;
  }
  if (protocol === 'blob:') return 'the browser has no such blob any more; revoke its address later';
  if (protocol === 'data:') return 'this is no data: address that can be read; correct it';
  if (!isWeb) return `pages cannot load ${protocol} addresses; serve the file over https`;
  if (username) return 'browsers load no address with a password in it; take it out';
  if (protocol === 'http:' && globalThis.origin?.startsWith('https:') && !/^(localhost|127\..*|\[::1])$/.test(hostname)) {
    return 'a page over https cannot load over http; use an https address';
  }
  return '';
}

/** Message for a server of which the browser accepts whole files but not ranges, for example compressed ones. */
export const rangeRefusal = (isOwn: boolean): string =>
  `the browser refuses parts of the file as the server sends them; let it send them without Content-Encoding${isOwn ? '' : ', and allow the header Range (Access-Control-Allow-Headers)'}`;

/** Message for a server that does not allow this page to read its answers. */
export function corsRefusal(credentials: RequestCredentials | undefined): string {
  const needed = credentials === 'include'
    ? `Access-Control-Allow-Origin: ${globalThis.origin} (* does not do with crossorigin="use-credentials") and Access-Control-Allow-Credentials: true`
    : 'Access-Control-Allow-Origin';
  return `the server answers, but does not allow this page to read it; let it send ${needed}, and allow the header Range`;
}
