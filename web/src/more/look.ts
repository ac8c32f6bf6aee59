// SPDX-License-Identifier: Apache-2.0
// Reads the characters' look from an element's attributes look, look-strength, light, light-turn and method="montage4d",
// which applies to layered characters, too. The player checks names and numbers. Errors: an Error for a picture that
// does not load. Part of fourdvt-more.js.
import { keep } from '../page/promises.js';
import { LOOKS, type Look } from '../wasm/generated/abi.js';
import type { WasmModule } from '../wasm/wasm-abi.js';

// Width of the environment picture for the player, sufficient for nine spherical-harmonic coefficients.
const LIGHT_WIDTH = 128;

/** Applies the look to a player; returns 0 if the player refuses it. */
export type LookCall = (module: WasmModule, handle: number) => number;

interface Light {
  pixels: Uint8ClampedArray;
  width: number;
  height: number;
}

const reported = new WeakSet<object>(); // owners with an event that the device cannot run the method

const lights = new Map<string, Promise<Light>>();

async function fetchLight(url: string): Promise<Light> {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`status ${answer.status}`);
  const picture = await createImageBitmap(await answer.blob(), { colorSpaceConversion: 'none' });
  const canvas = document.createElement('canvas');
  const width = (canvas.width = LIGHT_WIDTH);
  const height = (canvas.height = Math.max(1, Math.round((LIGHT_WIDTH * picture.height) / picture.width)));
  const context = canvas.getContext('2d', { willReadFrequently: true })!;
  context.imageSmoothingQuality = 'high';
  context.drawImage(picture, 0, 0, width, height);
  picture.close();
  return { pixels: context.getImageData(0, 0, width, height).data, width, height };
}

async function loadLight(address: string, base: string): Promise<Light> {
  try {
    const url = new URL(address, base).href;
    return await keep(lights, url, () => fetchLight(url));
  } catch (reason) {
    throw new Error(`light="${address}": the picture does not load (${String(reason)}); correct the address`);
  }
}

// Dispatches the event that characters from cameras have for a fallback (wasm/abi.txt), once per owner.
function tellFallback(element: Element, owner: object): void {
  if (reported.has(owner)) return;
  reported.add(owner);
  const message = 'montage4d needs half-float render targets, which this GPU does not have';
  element.dispatchEvent(new CustomEvent('methodfallback', { detail: { wanted: 'montage4d', drawn: 'layered', message } }));
}

/** Loads what the look needs. owner: gets at most one event if the device cannot run the element's method. */
export async function readLook(element: Element, owner: object = element): Promise<LookCall> {
  const look = LOOKS.indexOf((element.getAttribute('look') || 'none') as Look);
  const number = (name: string, otherwise: number): number => Number(element.getAttribute(name) ?? otherwise);
  const strength = number('look-strength', 1), turnDeg = number('light-turn', 0);
  const address = element.getAttribute('light');
  const light = address && LOOKS[look] === 'relit' ? await loadLight(address, element.baseURI) : null;
  const montage = element.getAttribute('method') === 'montage4d';
  return (module, handle) => {
    if (!montage) reported.delete(owner);
    if (!module._fdvt_use_montage(handle, montage ? 1 : 0)) tellFallback(element, owner);
    const at = light ? module._fdvt_alloc(light.pixels.length) : 0;
    if (light) module.HEAPU8.set(light.pixels, at);
    const ok = module._fdvt_set_look(handle, look, strength, turnDeg, at, light?.width ?? 0, light?.height ?? 0);
    module._fdvt_free(at);
    return ok;
  };
}
