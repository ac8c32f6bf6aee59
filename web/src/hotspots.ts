// SPDX-License-Identifier: Apache-2.0
// Hotspots: elements of the page that stay on a vertex of the character, <button slot="hotspot-…" data-vertex="…">. Part of fourdvt-more.js.
import { bytesOfView, readSurfacePoint, type ViewRecord } from './generated/abi.js';
import type { SidePlayer } from './session-side.js';
import type { WasmModule } from './wasm-abi.js';

const MARK = '[slot^=hotspot]';

/** Player and view of the canvas, as they are now. */
export interface HotspotScene {
  /** Null until the second part is there. */
  player(): SidePlayer | null;
  /** Null before there is a character. */
  layered(): boolean | null;
  pose(): Omit<ViewRecord, 'width' | 'height'>;
  /** Pixels of the canvas. */
  size(): { width: number; height: number };
  /** Brings a turn of the frame loop about. */
  wake(): void;
}

export class Hotspots {
  readonly #viewer: HTMLElement;
  readonly #root: ShadowRoot;
  readonly #scene: HotspotScene;
  readonly #changes = new MutationObserver(() => {
    this.#collect();
    this.#scene.wake();
  });
  readonly #slots = new Map<HTMLElement, HTMLSlotElement>();
  #refused = false; // the console has the reason

  constructor(viewer: HTMLElement, root: ShadowRoot, scene: HotspotScene) {
    this.#viewer = viewer;
    this.#root = root;
    this.#scene = scene;
    this.#changes.observe(viewer, { childList: true, subtree: true, attributeFilter: ['slot', 'data-vertex'] });
    this.#collect();
  }
  dispose(): void {
    this.#changes.disconnect();
    for (const slot of this.#slots.values()) slot.remove();
    this.#slots.clear();
  }

  /** A turn of the page's loop: puts them where their vertices are. `data-visible` is there while the surface faces the camera. */
  turn(): void {
    if (!this.#slots.size) return;
    const scene = this.#scene, layered = scene.layered();
    if (layered === false && !this.#refused) {
      this.#refused = true;
      console.warn('fourdvt-viewer: hotspots need a character from layers: the meshes of one from cameras change with every frame');
    }
    for (const slot of this.#slots.values()) slot.hidden = true;
    if (layered) this.#withView((m, handle, view, scale) => this.#place(m, handle, view, scale));
  }

  #place(m: WasmModule, handle: number, view: number, scale: number): void {
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

  /** The vertex nearest to a point of the page, CSS pixels; null where no surface is. */
  vertexAt(x: number, y: number): number | null {
    const { left, top } = this.#viewer.getBoundingClientRect();
    let vertex = -1;
    if (this.#scene.layered()) {
      this.#withView((m, handle, view, scale) => { vertex = m._fdvt_vertex_at(handle, view, (x - left) / scale, (y - top) / scale); });
    }
    return vertex < 0 ? null : vertex;
  }

  // scale: CSS pixels for each pixel of the canvas.
  #withView(action: (m: WasmModule, handle: number, view: number, scale: number) => void): void {
    const size = this.#scene.size(), scale = this.#viewer.clientHeight / size.height;
    this.#scene.player()?.tell((m, handle) => {
      const bytes = bytesOfView({ ...this.#scene.pose(), ...size }), view = m._fdvt_alloc(bytes.length);
      m.HEAPU8.set(bytes, view);
      action(m, handle, view, scale);
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
      this.#root.append(slot);
      this.#slots.set(element, slot);
    }
  }
}
