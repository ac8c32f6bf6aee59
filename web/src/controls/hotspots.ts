// SPDX-License-Identifier: Apache-2.0
// Hotspots: elements of the page, <button slot="hotspot-…" data-vertex="…">, each placed over a vertex of the character.
// Part of fourdvt-more.js.
import type { SidePlayer } from '../more/session-side.js';
import { pointInBox, type PictureBox } from '../page/picture-box.js';
import { bytesOfView, readSurfacePoint, type ViewRecord } from '../wasm/generated/abi.js';
import type { WasmModule } from '../wasm/wasm-abi.js';

const MARK = '[slot^=hotspot]';

/** Access to the present player and view of the canvas. */
export interface HotspotScene {
  /** Null until the second part is loaded. */
  player(): SidePlayer | null;
  /** True for a character from layers; null before a character is loaded. */
  layered(): boolean | null;
  pose(): Omit<ViewRecord, 'width' | 'height'>;
  readonly picture: Pick<PictureBox, 'size' | 'canvas' | 'corners'>;
  /** Requests a turn of the frame loop. */
  wake(): void;
}

export class Hotspots {
  readonly #viewer: HTMLElement;
  readonly #content: HTMLElement;
  readonly #scene: HotspotScene;
  readonly #changes = new MutationObserver(() => {
    this.#collect();
    this.#scene.wake();
  });
  readonly #slots = new Map<HTMLElement, HTMLSlotElement>();
  #refused = false; // the console has the reason

  /** content: element that fills the viewer's content box, and gets the hotspots' slots. */
  constructor(viewer: HTMLElement, content: HTMLElement, scene: HotspotScene) {
    this.#viewer = viewer;
    this.#content = content;
    this.#scene = scene;
    this.#changes.observe(viewer, { childList: true, subtree: true, attributeFilter: ['slot', 'data-vertex'] });
    this.#collect();
  }
  dispose(): void {
    this.#changes.disconnect();
    for (const slot of this.#slots.values()) slot.remove();
    this.#slots.clear();
  }

  /** Moves the hotspots to their vertices, once per turn; sets `data-visible` where the surface faces the camera. */
  turn(): void {
    if (!this.#slots.size) return;
    const scene = this.#scene, layered = scene.layered();
    if (layered === false && !this.#refused) {
      this.#refused = true;
      console.warn('fourdvt-viewer: hotspots need a character from layers: the meshes of one from cameras change with every frame');
    }
    for (const slot of this.#slots.values()) slot.hidden = true;
    if (layered) this.#withView((m, handle, view) => this.#place(m, handle, view));
  }

  #place(m: WasmModule, handle: number, view: number): void {
    const { size, canvas } = this.#scene.picture, scale = size.height / canvas.height;
    for (const [element, slot] of this.#slots) {
      const vertex = Number(element.dataset['vertex'] ?? NaN);
      const at = Number.isInteger(vertex) && vertex >= 0 ? m._fdvt_surface_point(handle, vertex, view) : 0;
      if (!at) continue;
      const { xPx, yPx, facing } = readSurfacePoint(m.HEAPU8, at);
      slot.hidden = false;
      slot.style.transform = `translate(${(scale * xPx).toFixed(1)}px, ${(scale * yPx).toFixed(1)}px) translate(-50%, -50%)`;
      element.toggleAttribute('data-visible', facing);
    }
  }

  /** Returns the vertex nearest to a point of the window, CSS pixels; null outside of the surface. */
  vertexAt(x: number, y: number): number | null {
    const { picture } = this.#scene, { width, height } = picture.canvas, at = pointInBox(picture.corners(), { x, y });
    const isInside = at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1;
    let vertex = -1;
    if (isInside && this.#scene.layered()) this.#withView((m, handle, view) => { vertex = m._fdvt_vertex_at(handle, view, at.x * width, at.y * height); });
    return vertex < 0 ? null : vertex;
  }

  #withView(action: (m: WasmModule, handle: number, view: number) => void): void {
    const { width, height } = this.#scene.picture.canvas;
    this.#scene.player()?.call((m, handle) => {
      const bytes = bytesOfView({ ...this.#scene.pose(), width, height }), view = m._fdvt_alloc(bytes.length);
      m.HEAPU8.set(bytes, view);
      action(m, handle, view);
      m._fdvt_free(view);
      return 1;
    });
  }

  #collect(): void {
    const found = new Set(this.#viewer.querySelectorAll<HTMLElement>(`:scope > ${MARK}`));
    for (const [element, slot] of this.#slots) {
      if (found.has(element) && slot.name === element.slot) continue;
      slot.remove();
      this.#slots.delete(element);
    }
    for (const element of found) {
      if (this.#slots.has(element)) continue;
      const slot = document.createElement('slot');
      slot.name = element.slot;
      slot.className = 'hotspot';
      slot.hidden = true;
      this.#content.append(slot);
      this.#slots.set(element, slot);
    }
  }
}
