// SPDX-License-Identifier: Apache-2.0
// Rendition by an element's attribute `quality`: 'auto', 'highest', or a number, 0 for the lowest. Any other text is 'auto': the
// network's throughput decides, limited to the texels that are visible at the element's size; the lowest one if the visitor saves data.

/** Arguments of fdvt_set_quality, wasm/abi.txt. */
export interface Quality {
  rendition: number;
  maxTexels: number;
}

const HIGHEST = -1, AUTOMATIC = -2; // of fdvt_set_quality
const TEXELS_PER_PIXEL = 4; // of layer 1, per pixel of the element's height: more are not seen

/** The visitor saves data. */
export const savesData = (): boolean =>
  (navigator as { connection?: { saveData?: boolean } }).connection?.saveData === true || matchMedia('(prefers-reduced-data: reduce)').matches;

export function qualityOf(element: Element, heightPixels: number): Quality {
  const quality = element.getAttribute('quality') || 'auto', number = Number(quality);
  if (quality === 'highest') return { rendition: HIGHEST, maxTexels: 0 };
  if (Number.isInteger(number) && number >= 0) return { rendition: number, maxTexels: 0 };
  return savesData() ? { rendition: 0, maxTexels: 0 } : { rendition: AUTOMATIC, maxTexels: TEXELS_PER_PIXEL * heightPixels };
}
