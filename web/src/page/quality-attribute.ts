// SPDX-License-Identifier: Apache-2.0
// Reads the rendition from an element's attribute `quality`: 'highest', a number (0: the lowest) or 'auto', as which any
// other text counts. 'auto' selects by network throughput, limited to the texels visible at the element's size; the
// lowest rendition for visitors who save data.

/** Arguments of fdvt_set_quality, wasm/abi.txt. */
export interface Quality {
  rendition: number;
  maxTexels: number;
}

const HIGHEST = -1, AUTOMATIC = -2; // values for fdvt_set_quality
const TEXELS_PER_PIXEL = 4; // maximum of layer 1 per pixel of the element's height: more are not visible

/** Returns true if the browser is set to save data. */
export const savesData = (): boolean =>
  (navigator as { connection?: { saveData?: boolean } }).connection?.saveData === true || matchMedia('(prefers-reduced-data: reduce)').matches;

export function qualityOf(element: Element, heightPixels: number): Quality {
  const quality = element.getAttribute('quality') || 'auto', number = Number(quality);
  if (quality === 'highest') return { rendition: HIGHEST, maxTexels: 0 };
  if (Number.isInteger(number) && number >= 0) return { rendition: number, maxTexels: 0 };
  return savesData() ? { rendition: 0, maxTexels: 0 } : { rendition: AUTOMATIC, maxTexels: TEXELS_PER_PIXEL * heightPixels };
}
