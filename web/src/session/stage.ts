// SPDX-License-Identifier: Apache-2.0
// One instance of the player and one WebGL2 context, shared by all viewers of the page. A single viewer shows the context's
// canvas. Several viewers are drawn in turn and show canvases of their own. Their pictures are transferred as bitmaps of an
// OffscreenCanvas, or copied from the first viewer's canvas if the others came later or OffscreenCanvas is missing. After a
// lost context or a trap of the player all viewers begin again on another stage. Does not load or draw characters.
import type { Report } from '../net/requests.js';
import { keep } from '../page/promises.js';
import { instantiate } from '../player/wasm-module.js';
import { ViewerError } from '../report/errors.js';
import type { WasmModule } from '../wasm/wasm-abi.js';

const LINGER_MS = 2000; // lifetime after the last viewer has left, as another may join at once

/** A viewer on the stage. */
export interface StageSlot {
  /** Shows this canvas in place of the last one. */
  show(canvas: HTMLCanvasElement): void;
  /** Draws again at once, since the viewer gets another canvas. */
  redraw(): void;
  /** Bytes in use on the GPU and in the player's memory, by all viewers of the stage; 0 without a player. */
  bytes(): number;
  /** Called when the context is lost; `restored` follows if the browser restores it. True: the viewer joins again. */
  lost(): void;
  restored(): boolean;
  /** Called when the player has trapped in another viewer's call: all must load again, on another stage. */
  trapped(): void;
}

type ContextCanvas = HTMLCanvasElement | OffscreenCanvas;
type Renderer = CanvasRenderingContext2D | ImageBitmapRenderingContext;

const CONTEXT: WebGLContextAttributes = {
  alpha: true, premultipliedAlpha: true, antialias: false, depth: false, stencil: false, powerPreference: 'high-performance',
};

const stages = new Map<string, Promise<Stage>>(); // by the address of the wasm file
const open = new Set<Stage>();
let spare: ContextCanvas | null = null; // canvas whose context has been restored

function takeCanvas(several: boolean): ContextCanvas {
  const canvas = spare ?? (several && globalThis.OffscreenCanvas ? new OffscreenCanvas(1, 1) : document.createElement('canvas'));
  spare = null;
  return canvas;
}

export class Stage {
  readonly module: WasmModule;
  readonly gl: WebGL2RenderingContext;
  /** Handle of the context in the module. */
  readonly context: number;
  readonly #url: string;
  readonly #canvas: ContextCanvas;
  readonly #slots = new Set<StageSlot>();
  readonly #own = new Map<StageSlot, Renderer>(); // canvases of viewers that do not show the context's canvas
  #timer = 0;
  #over = false; // closed: no viewer may join

  /** Number of viewers in the page's documents, with or without a stage. */
  static viewers = 0;

  /** Joins the page's stage, or creates it. Errors: ViewerError of `instantiate`, 'gpu-failure'. */
  static async join(files: { readonly wasm: string }, slot: StageSlot, report: Report): Promise<Stage> {
    const { wasm: url } = files;
    const stage = await keep(stages, url, () => instantiate(files, report).then((module) => new Stage(url, module)));
    if (stage.#over) return Stage.join(files, slot, report);
    stage.#add(slot);
    return stage;
  }

  /** Bytes in use on the GPU and in the player's memory, by all viewers of the page. */
  static usedBytes(): number {
    let bytes = 0;
    for (const stage of open) {
      for (const slot of stage.#slots) {
        const held = slot.bytes(); // of the whole stage
        bytes += held;
        if (held) break;
      }
      for (const { canvas } of stage.#own.values()) bytes += 4 * canvas.width * canvas.height;
    }
    return bytes;
  }

  private constructor(url: string, module: WasmModule) {
    let canvas = takeCanvas(Stage.viewers > 1), gl = canvas.getContext('webgl2', CONTEXT) as WebGL2RenderingContext | null;
    if (!gl && !('style' in canvas)) { // Safari 16 has OffscreenCanvas, but without WebGL
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

  /** Closes the stage after a trap in a call by a viewer that has left; the other viewers' sessions end. */
  fail(): void {
    this.#end();
    for (const slot of [...this.#slots]) slot.trapped();
  }

  // --- pictures ---

  /** Resizes the context's canvas for the viewer's next picture, which is drawn into the lower left corner. */
  fit(slot: StageSlot, width: number, height: number): void {
    const canvas = this.#canvas, grows = 'style' in canvas && this.#own.has(slot);
    const [w, h] = grows ? [Math.max(canvas.width, width), Math.max(canvas.height, height)] : [width, height];
    if (canvas.width !== w) canvas.width = w;
    if (canvas.height !== h) canvas.height = h;
  }
  /** Shows the viewer's picture that has just been drawn. width, height: its size, pixels. */
  present(slot: StageSlot, width: number, height: number): void {
    const renderer = this.#own.get(slot);
    if (!renderer) return;
    const { canvas } = renderer;
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    if ('drawImage' in renderer) this.#copy(renderer, width, height);
    else renderer.transferFromImageBitmap((this.#canvas as OffscreenCanvas).transferToImageBitmap());
  }
  /** Makes a PNG of the picture that has just been drawn. width, height: its size, pixels. */
  toBlob(slot: StageSlot, width: number, height: number): Promise<Blob | null> {
    let from = this.#canvas;
    if (!('style' in from)) return from.convertToBlob();
    if (this.#own.has(slot)) {
      from = Object.assign(document.createElement('canvas'), { width, height });
      this.#copy(from.getContext('2d')!, width, height);
      this.#canvas.width = this.#canvas.height = 1; // frees the memory of a large snapshot
    }
    return new Promise((resolve) => (from as HTMLCanvasElement).toBlob(resolve)); // the canvas's present content
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

  // Closes the stage, and frees the context without waiting for garbage collection.
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
