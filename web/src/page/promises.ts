// SPDX-License-Identifier: Apache-2.0
// Deferred promises, and a cache of promises by key.

/** Promise with its resolve and reject. An unhandled rejection is not reported. */
export interface Deferred {
  promise: Promise<void>;
  resolve(): void;
  reject(reason: Error): void;
}

export function deferred(): Deferred {
  let [resolve, reject]: [() => void, (reason: Error) => void] = [() => undefined, () => undefined];
  const promise = new Promise<void>((yes, no) => { [resolve, reject] = [yes, no]; });
  promise.catch(() => undefined);
  return { promise, resolve, reject };
}

interface Kept<Key, Value> {
  get(key: Key): Promise<Value> | undefined;
  set(key: Key, value: Promise<Value>): unknown;
  delete(key: Key): unknown;
}

/** Returns the cached promise of a key, or caches a new one; removes it when it is rejected. */
export function keep<Key, Value>(kept: Kept<Key, Value>, key: Key, make: () => Promise<Value>): Promise<Value> {
  let promise = kept.get(key);
  if (!promise) {
    kept.set(key, (promise = make()));
    promise.catch(() => kept.delete(key));
  }
  return promise;
}
