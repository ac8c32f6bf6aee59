// SPDX-License-Identifier: Apache-2.0
// A promise that others settle. Who does not wait for it need not handle its rejection.
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
