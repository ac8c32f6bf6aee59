// SPDX-License-Identifier: Apache-2.0
// Geometry of a viewer's picture, which fills the content box: size of the canvas, and conversion from points of the
// window to the picture, for pointers, drags and hotspots.
import { viewOf } from './documents.js';

const MAX_PIXEL_RATIO = 2;

export interface Size {
  readonly width: number;
  readonly height: number;
}
export interface Point {
  readonly x: number;
  readonly y: number;
}
/** Upper left, upper right and lower left corner of a box in the window, after transforms; CSS pixels. */
export type Corners = readonly [Point, Point, Point];

/** Size in pixels of a canvas that fills a box of CSS pixels. */
export function canvasSize({ width, height }: Size, pixelRatio: number): Size {
  const ratio = Math.min(pixelRatio, MAX_PIXEL_RATIO);
  return { width: Math.round(width * ratio), height: Math.round(height * ratio) };
}

/** Maps a point of the window into a box under any affine transform: 0…1 from left to right and from top to bottom. */
export function pointInBox([corner, right, low]: Corners, { x, y }: Point): Point {
  const across = { x: right.x - corner.x, y: right.y - corner.y }, down = { x: low.x - corner.x, y: low.y - corner.y };
  const from = { x: x - corner.x, y: y - corner.y }, area = across.x * down.y - across.y * down.x;
  return { x: (from.x * down.y - from.y * down.x) / area, y: (across.x * from.y - across.y * from.x) / area };
}

export class PictureBox {
  readonly #content: HTMLElement;
  readonly #marks: HTMLElement[] = []; // elements without size in the corners
  #view: typeof globalThis = globalThis;
  #changed: () => void = () => undefined;
  #ratio = 1; // device pixels per CSS pixel
  #size: Size = { width: 1, height: 1 };
  #canvas: Size = { width: 1, height: 1 };

  /** content: a positioned element that fills the viewer's content box. */
  constructor(content: HTMLElement) {
    this.#content = content;
  }

  /** Size in CSS pixels, before transforms and zoom of the page. */
  get size(): Size { return this.#size; }
  /** Size of the canvas, pixels. */
  get canvas(): Size { return this.#canvas; }

  /** Observes the box's size and its window's pixel ratio; calls `changed` at once and at each change. */
  watch(changed: () => void, signal: AbortSignal): void {
    const view = (this.#view = viewOf(this.#content));
    this.#changed = changed;
    const sizes = new view.ResizeObserver((entries) => this.#update(entries[entries.length - 1]!.contentRect));
    sizes.observe(this.#content);
    signal.addEventListener('abort', () => sizes.disconnect());
    const followRatio = (): void => view.matchMedia(`(resolution: ${view.devicePixelRatio}dppx)`).addEventListener('change', () => {
      this.checkRatio();
      followRatio();
    }, { once: true, signal });
    followRatio();
  }
  /** Reads the pixel ratio again: browsers may be late with the event of its change. */
  checkRatio(): void {
    if (this.#view.devicePixelRatio !== this.#ratio) this.#update(this.#size);
  }
  #update(size: Size): void {
    this.#size = size;
    this.#ratio = this.#view.devicePixelRatio;
    this.#canvas = canvasSize(size, this.#ratio);
    this.#changed();
  }

  /** Present corners of the picture in the window, after transforms; CSS pixels. */
  corners(): Corners {
    const [corner, right, low] = this.#makeMarks().map((mark) => mark.getBoundingClientRect());
    return [corner!, right!, low!];
  }
  #makeMarks(): HTMLElement[] {
    if (!this.#marks.length) {
      for (const [left, top] of [['0', '0'], ['100%', '0'], ['0', '100%']]) {
        const mark = document.createElement('i');
        Object.assign(mark.style, { position: 'absolute', left, top });
        this.#content.append(mark);
        this.#marks.push(mark);
      }
    }
    return this.#marks;
  }
}
