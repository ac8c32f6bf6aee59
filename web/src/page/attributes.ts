// SPDX-License-Identifier: Apache-2.0
// Settings of an element by its page: boolean attributes, and properties from before it was defined.

/** A boolean attribute is there. "false" is off: frameworks write it where a page has set false. */
export const isOn = (element: Element, name: string): boolean => (element.getAttribute(name) ?? 'false') !== 'false';

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
