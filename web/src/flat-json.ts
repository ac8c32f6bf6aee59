// SPDX-License-Identifier: Apache-2.0
// Flattens JSON to pairs of JSON pointer and value, as native/base/flat_json.h takes them. Leaves out null and empty
// containers.

export type Leaf = number | string | boolean;

export function flattenJson(root: unknown, visit: (pointer: string, value: Leaf) => void): void {
  const walk = (value: unknown, pointer: string): void => {
    if (typeof value === 'number' || typeof value === 'string' || typeof value === 'boolean') visit(pointer, value);
    if (typeof value !== 'object' || value === null) return;
    for (const [key, child] of Object.entries(value)) {
      walk(child, `${pointer}/${key.replaceAll('~', '~0').replaceAll('/', '~1')}`);
    }
  };
  walk(root, '');
}
