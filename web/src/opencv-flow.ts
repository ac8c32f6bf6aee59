// SPDX-License-Identifier: Apache-2.0
// Connects the player to OpenCV's optical flow, a second wasm module that is loaded only when it is asked for: the
// reference for the GPU's flow, and the fallback where the GPU has no float render targets. Copies the pictures from
// one module's memory to the other's. Part of fourdvt-more.js.
import type { OpencvModule, WasmModule } from './wasm-abi.js';

type CreateModule = (options: object) => Promise<OpencvModule>;
const BYTES_PER_VECTOR = 8; // of the flow: two floats

const loading = new Map<string, Promise<OpencvModule>>();

async function load(url: string): Promise<OpencvModule> {
  try {
    const { default: create } = (await import(url)) as { default: CreateModule };
    return await create({ printErr: (line: string) => console.warn(`fourdvt-viewer: ${line}`) });
  } catch (reason) {
    loading.delete(url);
    throw new Error(`${url}: the OpenCV module does not load (${String(reason)}); put it and its .wasm beside the player`);
  }
}

/** Loads the module; afterwards the player can align with 'flow-opencv'. Errors: an Error that says what to do. */
export async function loadOpenCvFlow(url: string, player: WasmModule): Promise<void> {
  let module = loading.get(url);
  if (!module) loading.set(url, (module = load(url)));
  const flow = await module;
  player.fourdvtFlow = (a, b, width, height, out) => {
    const pixels = width * height;
    // The field comes first, so that it is aligned.
    const field = flow._fdvt_flow_alloc((BYTES_PER_VECTOR + 2) * pixels);
    if (!field) return 0;
    const first = field + BYTES_PER_VECTOR * pixels;
    flow.HEAPU8.set(player.HEAPU8.subarray(a, a + pixels), first);
    flow.HEAPU8.set(player.HEAPU8.subarray(b, b + pixels), first + pixels);
    const ok = flow._fdvt_flow_farneback(first, first + pixels, width, height, field);
    if (ok) player.HEAPU8.set(flow.HEAPU8.subarray(field, first), out);
    flow._fdvt_flow_free(field);
    return ok;
  };
}
