// SPDX-License-Identifier: Apache-2.0
// What pages set on an element: properties from before it was defined.

/** Sets again what a page has set before the element was defined: as properties of its own they would hide the class's for ever. */
export function upgradeProperties<T extends object>(element: T): void {
  for (const name of Object.keys(element) as (keyof T)[]) {
    if (!(name in Object.getPrototypeOf(element))) continue;
    const value = element[name];
    delete element[name];
    try {
      element[name] = value;
    } catch (reason) {
      queueMicrotask(() => { throw reason; }); // as the page would have met it
    }
  }
}
