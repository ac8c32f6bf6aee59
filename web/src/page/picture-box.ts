// SPDX-License-Identifier: Apache-2.0
// Geometry of a viewer's picture: canvas size, and points of the page in the picture, for pointers, drags and hotspots. The canvas fills
// the viewer's content box.
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
/** Corners of a box as the page shows it: upper left, upper right, lower left. */
export type Corners = readonly [Point, Point, Point];

/** Size in pixels of a canvas that fills a box of CSS pixels. */
export function canvasSize({ width, height }: Size, pixelRatio: number): Size {
  const ratio = Math.min(pixelRatio, MAX_PIXEL_RATIO);
  return { width: Math.round(width * ratio), height: Math.round(height * ratio) };
}

/** Maps a point of the page into a box that may be moved, scaled, turned and sheared: 0…1 from its left to its right and from its top to its bottom. */
export function pointInBox([corner, right, low]: Corners, { x, y }: Point): Point {
  const across = { x: right.x - corner.x, y: right.y - corner.y }, down = { x: low.x - corner.x, y: low.y - corner.y };
  const from = { x: x - corner.x, y: y - corner.y }, area = across.x * down.y - across.y * down.x;
  return { x: (from.x * down.y - from.y * down.x) / area, y: (across.x * from.y - across.y * from.x) / area };
}

export class PictureBox {
  readonly #content: HTMLElement;
  readonly #marks: HTMLElement[] = []; // without size, in its corners
  #view: typeof globalThis = globalThis;
  #changed: () => void = () => undefined;
  #ratio = 1; // pixels for each of CSS
  #size: Size = { width: 1, height: 1 };
  #canvas: Size = { width: 1, height: 1 };

  /** content: a positioned element that fills the viewer's content box. */
  constructor(content: HTMLElement) {
    this.#content = content;
  }

  /** CSS pixels, before transforms and zoom of the page. */
  get size(): Size { return this.#size; }
  /** Pixels of the canvas. */
  get canvas(): Size { return this.#canvas; }

  /** Follows the box's size, and the pixel ratio of the window that shows it. `changed` is called at each change, and once at the beginning. */
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

  /** Its corners as the page shows them now: CSS pixels of the window. */
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
