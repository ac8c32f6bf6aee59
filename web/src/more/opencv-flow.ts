// SPDX-License-Identifier: Apache-2.0
// Connects the player to OpenCV's optical flow, a second wasm module that is loaded on demand: the reference for the
// GPU's flow, and the fallback without float render targets. Copies pictures and flow between the modules' memories.
// Part of fourdvt-more.js.
import { keep } from '../page/promises.js';
import type { PlayerFiles } from '../wasm/files.js';
import type { OpencvModule, WasmModule } from '../wasm/wasm-abi.js';

type Files = Pick<PlayerFiles, 'opencv' | 'opencvWasm'>;
type CreateModule = (options: object) => Promise<OpencvModule>;
const BYTES_PER_VECTOR = 8; // two floats per pixel of the flow

const loading = new Map<string, Promise<OpencvModule>>();

async function load({ opencv: url, opencvWasm }: Files): Promise<OpencvModule> {
  try {
    const { default: create } = (await import(url)) as { default: CreateModule };
    const wasm = await fetch(opencvWasm);
    if (!wasm.ok) throw new Error(`${opencvWasm}: HTTP ${wasm.status}`);
    return await create({ wasmBinary: await wasm.arrayBuffer(), printErr: (line: string) => console.warn(`fourdvt-viewer: ${line}`) });
  } catch (reason) {
    throw new Error(`${url}: the OpenCV module does not load (${String(reason)}); put it and its .wasm beside the player`);
  }
}

/** Loads the module and enables the player's align mode 'flow-opencv'. Errors: an Error with the remedy. */
export async function loadOpenCvFlow(files: Files, player: WasmModule): Promise<void> {
  const flow = await keep(loading, files.opencv, () => load(files));
  player.fourdvtFlow = (a, b, width, height, out) => {
    const pixels = width * height;
    // The flow's floats come first, for their alignment.
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
