// SPDX-License-Identifier: Apache-2.0
// OpenCV's optical flow as a second wasm module, loaded only when asked for: the reference, and the fallback where the
// GPU has no float render targets. Copies pictures between the two modules' memories.
import { ViewerError } from './errors.js';
import type { WasmModule } from './wasm-abi.js';

interface FlowModule {
  HEAPU8: Uint8Array;
  _fdvt_flow_alloc(bytes: number): number;
  _fdvt_flow_free(pointer: number): void;
  /** 1, or 0 if it cannot. out: 2 floats a pixel. */
  _fdvt_flow_farneback(a: number, b: number, width: number, height: number, out: number): number;
}
type CreateFlow = (options: object) => Promise<FlowModule>;

const loading = new Map<string, Promise<FlowModule>>();

async function load(url: string): Promise<FlowModule> {
  try {
    const { default: create } = (await import(url)) as { default: CreateFlow };
    return await create({ printErr: (line: string) => console.warn(`fourdvt-viewer: ${line}`) });
  } catch (reason) {
    loading.delete(url);
    throw new ViewerError('fetch-failed', `${url}: the OpenCV module does not load (${String(reason)}); put it and its .wasm beside the player`);
  }
}

/** Afterwards the player's align 'flow-opencv' works. */
export async function loadOpenCvFlow(url: string, player: WasmModule): Promise<void> {
  let module = loading.get(url);
  if (!module) loading.set(url, (module = load(url)));
  const flow = await module;
  player.fourdvtFlow = (a, b, width, height, out) => {
    const pixels = width * height;
    const at = flow._fdvt_flow_alloc(10 * pixels);
    if (!at) return 0;
    const [first, second] = [at + 8 * pixels, at + 9 * pixels]; // the field comes first: it is aligned
    flow.HEAPU8.set(player.HEAPU8.subarray(a, a + pixels), first);
    flow.HEAPU8.set(player.HEAPU8.subarray(b, b + pixels), second);
    const ok = flow._fdvt_flow_farneback(first, second, width, height, at);
    if (ok) player.HEAPU8.set(flow.HEAPU8.subarray(at, at + 8 * pixels), out);
    flow._fdvt_flow_free(at);
    return ok;
  };
}
