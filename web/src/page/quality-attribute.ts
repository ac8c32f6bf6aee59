// SPDX-License-Identifier: Apache-2.0
// Which rendition an element plays, as its attribute `quality` says: 'auto', 'highest', or a number, 0 for the lowest.
// Anything else is 'auto': what the network carries, but no finer texels than a thumbnail shows, and the lowest rendition
// for visitors who save data.
/** Which rendition is played; see fdvt_set_quality in wasm/abi.txt. */
export interface Quality {
  rendition: number;
  mostTexels: number;
}

const HIGHEST = -1, AUTOMATIC = -2; // as fdvt_set_quality of wasm/abi.txt takes them
const TEXELS_PER_PIXEL = 4; // of layer 1, per pixel of the element's height: more are not seen

/** The visitor wants little to be transferred. */
export const savesData = (): boolean =>
  (navigator as { connection?: { saveData?: boolean } }).connection?.saveData === true || matchMedia('(prefers-reduced-data: reduce)').matches;

export function qualityOf(element: Element, heightPixels: number): Quality {
  const quality = element.getAttribute('quality') || 'auto', number = Number(quality);
  if (quality === 'highest') return { rendition: HIGHEST, mostTexels: 0 };
  if (Number.isInteger(number) && number >= 0) return { rendition: number, mostTexels: 0 };
  return savesData() ? { rendition: 0, mostTexels: 0 } : { rendition: AUTOMATIC, mostTexels: TEXELS_PER_PIXEL * heightPixels };
}
