// SPDX-License-Identifier: Apache-2.0
// Promises that are settled by other code, and promises that are kept by a key.

/** A rejection that nobody handles is no error. */
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

/** The promise kept by this key, or a new one. One that is rejected is not kept. */
export function keep<Key, Value>(kept: Kept<Key, Value>, key: Key, make: () => Promise<Value>): Promise<Value> {
  let promise = kept.get(key);
  if (!promise) {
    kept.set(key, (promise = make()));
    promise.catch(() => kept.delete(key));
  }
  return promise;
}
