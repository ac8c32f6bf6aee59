// SPDX-License-Identifier: Apache-2.0
// Flattens JSON to pairs of JSON pointer and value for native/base/flat_json.h. Leaves out nulls and empty containers.
// Errors: ViewerError 'manifest-invalid' for JSON nested deeper than any manifest.

import { ViewerError } from '../report/errors.js';

export type Leaf = number | string | boolean;

export function flattenJson(root: unknown, visit: (pointer: string, value: Leaf) => void): void {
  const walk = (value: unknown, pointer: string, depth: number): void => {
    if (depth > 64) throw new ViewerError('manifest-invalid', 'character.gltf: nested deeper than 64; bake the character again');
    if (typeof value === 'number' || typeof value === 'string' || typeof value === 'boolean') visit(pointer, value);
    if (typeof value !== 'object' || value === null) return;
    for (const [key, child] of Object.entries(value)) {
      walk(child, `${pointer}/${key.replaceAll('~', '~0').replaceAll('/', '~1')}`, depth + 1);
    }
  };
  walk(root, '', 0);
}
