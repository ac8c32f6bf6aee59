// SPDX-License-Identifier: Apache-2.0
// One instance of the player and one WebGL2 context, shared by all viewers of the page. A single viewer shows the context's canvas
// itself. Several are drawn one after the other and show canvases of their own, into which pictures are transferred as bitmaps of an
// OffscreenCanvas, or copied from the first one's canvas if the others came later or there is no OffscreenCanvas. After a lost context
// or a trap of the player all viewers begin again on another stage. Does not load or draw characters.
import type { Report } from '../net/requests.js';
import { keep } from '../page/promises.js';
import { instantiate } from '../player/wasm-module.js';
import { ViewerError } from '../report/errors.js';
import type { WasmModule } from '../wasm/wasm-abi.js';

const LINGER_MS = 2000; // after the last viewer has left: the next one may come at once

/** A viewer on the stage. */
export interface StageSlot {
  /** Shows this canvas, in place of any before. */
  show(canvas: HTMLCanvasElement): void;
  /** Draws again at once: the canvas that it shows is about to be shared. */
  redraw(): void;
  /** In use on the GPU and in the player's memory, by all viewers of its stage. */
  bytes(): number;
  /** The context is lost; `restored` follows if the browser gives it back. True if the viewer joins again. */
  lost(): void;
  restored(): boolean;
  /** The player has trapped in another viewer's call: all must be loaded again, on another stage. */
  trapped(): void;
}

type ContextCanvas = HTMLCanvasElement | OffscreenCanvas;
type Renderer = CanvasRenderingContext2D | ImageBitmapRenderingContext;

const CONTEXT: WebGLContextAttributes = {
  alpha: true, premultipliedAlpha: true, antialias: false, depth: false, stencil: false, powerPreference: 'high-performance',
};

const stages = new Map<string, Promise<Stage>>(); // by address of the player's wasm
const open = new Set<Stage>();
let spare: ContextCanvas | null = null; // whose context has come back

function takeCanvas(several: boolean): ContextCanvas {
  const canvas = spare ?? (several && globalThis.OffscreenCanvas ? new OffscreenCanvas(1, 1) : document.createElement('canvas'));
  spare = null;
  return canvas;
}

export class Stage {
  readonly module: WasmModule;
  readonly gl: WebGL2RenderingContext;
  /** The context, by its number in the player. */
  readonly context: number;
  readonly #url: string;
  readonly #canvas: ContextCanvas;
  readonly #slots = new Set<StageSlot>();
  readonly #own = new Map<StageSlot, Renderer>(); // of viewers that do not show the context's canvas
  #timer = 0;
  #over = false; // no viewer may join any more

  /** Viewers of the page, on a stage or not yet. */
  static viewers = 0;

  /** Joins the page's stage. Errors: ViewerError as of `instantiate`, 'gpu-failure'. */
  static async join(files: { readonly wasm: string }, slot: StageSlot, report: Report): Promise<Stage> {
    const { wasm: url } = files;
    const stage = await keep(stages, url, () => instantiate(files, report).then((module) => new Stage(url, module)));
    if (stage.#over) return Stage.join(files, slot, report);
    stage.#add(slot);
    return stage;
  }

  /** In use on the GPU and in the player's memory, by all viewers of the page. */
  static usedBytes(): number {
    let bytes = 0;
    for (const stage of open) {
      for (const slot of stage.#slots) {
        const held = slot.bytes(); // counts every block of the heap
        bytes += held;
        if (held) break;
      }
      for (const { canvas } of stage.#own.values()) bytes += 4 * canvas.width * canvas.height;
    }
    return bytes;
  }

  private constructor(url: string, module: WasmModule) {
    let canvas = takeCanvas(Stage.viewers > 1), gl = canvas.getContext('webgl2', CONTEXT) as WebGL2RenderingContext | null;
    if (!gl && !('style' in canvas)) { // Safari 16 has such canvases, but not for WebGL
      canvas = takeCanvas(false);
      gl = canvas.getContext('webgl2', CONTEXT) as WebGL2RenderingContext | null;
    }
    if (!gl) throw new ViewerError('gpu-failure', 'no WebGL2 context: the browser or its GPU driver refuses one');
    this.#url = url;
    this.#canvas = canvas;
    this.module = module;
    this.gl = gl;
    this.context = module.GL.registerContext(gl, { majorVersion: 2, minorVersion: 0 });
    canvas.addEventListener('webglcontextlost', this.#onLost);
    open.add(this);
  }

  leave(slot: StageSlot): void {
    this.#own.delete(slot);
    if (!this.#slots.delete(slot) || this.#slots.size || this.#over) return;
    this.#timer = setTimeout(() => this.#end(), LINGER_MS);
  }

  /** A viewer that has left has trapped in a call: the player cannot be used any more. */
  fail(): void {
    this.#end();
    for (const slot of [...this.#slots]) slot.trapped();
  }

  // --- pictures ---

  /** Makes room for a picture of the viewer, in the lower left corner of the context's canvas. */
  fit(slot: StageSlot, width: number, height: number): void {
    const canvas = this.#canvas, grows = 'style' in canvas && this.#own.has(slot);
    const [w, h] = grows ? [Math.max(canvas.width, width), Math.max(canvas.height, height)] : [width, height];
    if (canvas.width !== w) canvas.width = w;
    if (canvas.height !== h) canvas.height = h;
  }
  /** Shows the picture that has just been drawn, of this size. */
  present(slot: StageSlot, width: number, height: number): void {
    const renderer = this.#own.get(slot);
    if (!renderer) return;
    const { canvas } = renderer;
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    if ('drawImage' in renderer) this.#copy(renderer, width, height);
    else renderer.transferFromImageBitmap((this.#canvas as OffscreenCanvas).transferToImageBitmap());
  }
  /** A PNG of the picture that has just been drawn, of this size. */
  toBlob(slot: StageSlot, width: number, height: number): Promise<Blob | null> {
    let from = this.#canvas;
    if (!('style' in from)) return from.convertToBlob();
    if (this.#own.has(slot)) {
      from = Object.assign(document.createElement('canvas'), { width, height });
      this.#copy(from.getContext('2d')!, width, height);
      this.#canvas.width = this.#canvas.height = 1; // one of that size is not needed again
    }
    return new Promise((resolve) => (from as HTMLCanvasElement).toBlob(resolve)); // of what the canvas shows now
  }

  #copy(to: CanvasRenderingContext2D, width: number, height: number): void {
    to.globalCompositeOperation = 'copy';
    to.drawImage(this.#canvas, 0, this.#canvas.height - height, width, height, 0, 0, width, height);
  }

  // --- viewers ---

  #add(slot: StageSlot): void {
    const canvas = this.#canvas;
    clearTimeout(this.#timer);
    for (const other of this.#slots) if (!this.#own.has(other)) this.#giveCanvas(other);
    if (this.#slots.size || !('style' in canvas)) {
      this.#giveCanvas(slot);
    } else {
      canvas.width = canvas.width; // clears the last viewer's picture
      slot.show(canvas);
    }
    this.#slots.add(slot);
  }
  #giveCanvas(slot: StageSlot): void {
    const canvas = document.createElement('canvas'), renderer = canvas.getContext(('style' in this.#canvas ? '2d' : 'bitmaprenderer') as '2d');
    if (!renderer) throw new ViewerError('gpu-failure', 'no canvas for the picture: the browser refuses one');
    this.#own.set(slot, renderer);
    slot.redraw();
    slot.show(canvas);
  }

  // Frees the context before the next garbage collection.
  #end(): void {
    this.#close();
    this.gl.getExtension('WEBGL_lose_context')?.loseContext();
  }
  #close(): void {
    this.#over = true;
    stages.delete(this.#url);
    open.delete(this);
    this.#canvas.removeEventListener('webglcontextlost', this.#onLost);
  }
  readonly #onLost = (e: Event): void => {
    e.preventDefault(); // lets the browser restore it
    this.#close();
    const slots = [...this.#slots], canvas = this.#canvas;
    canvas.addEventListener('webglcontextrestored', () => {
      spare = canvas;
      if (!slots.map((slot) => slot.restored()).includes(true)) spare = null;
    }, { once: true });
    for (const slot of slots) slot.lost();
  };
}
