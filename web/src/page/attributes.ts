// SPDX-License-Identifier: Apache-2.0
// Boolean attributes, and properties that were set before the element was defined.

/** Value of a boolean attribute; "false", which frameworks write, is off. */
export const isOn = (element: Element, name: string): boolean => (element.getAttribute(name) ?? 'false') !== 'false';

/** Assigns properties that a page set before the element was defined to the accessors of its class. */
export function upgradeProperties<T extends object>(element: T): void {
  for (const name of Object.keys(element) as (keyof T)[]) {
    if (!(name in Object.getPrototypeOf(element))) continue;
    const value = element[name];
    delete element[name];
    try {
      element[name] = value;
    } catch (reason) {
      queueMicrotask(() => { throw reason; }); // reported as the page's uncaught error
    }
  }
}
