// SPDX-License-Identifier: Apache-2.0
// Turns the orbit by pointer, wheel and keys. Vertical swipes still scroll the page (touch-action: pan-y). The wheel
// zooms only with Ctrl (which a trackpad's pinch sends), with the `zoom` attribute, or after a click until the pointer
// leaves the element.
import { pointInBox, type Corners, type PictureBox, type Point } from '../page/picture-box.js';
import type { OrbitCamera } from './orbit-camera.js';

const KEY_STEP_DEG = 10;
const KEY_ZOOM = 1.15;
const DRAG_DEG_PER_HEIGHT = 240;

export interface ControlsHost {
  /** Returns false if the visitor cannot turn the orbit: then only the key for play and pause works. */
  orbits(): boolean;
  wheelZooms(): boolean;
  /** Factors on a drag's rotation, and on the zoom by wheel, pinch and keys; 0: disabled. */
  sensitivity(): { orbit: number; zoom: number };
  onInteract(): void;
  togglePlay(): void;
}

export class OrbitControls {
  readonly #stage: HTMLElement;
  readonly #camera: OrbitCamera;
  readonly #picture: PictureBox;
  readonly #host: ControlsHost;
  readonly #abort = new AbortController();
  readonly #pointers = new Map<number, Point>(); // positions in heights of the picture, by pointer id
  #corners: Corners | null = null; // of the picture when the first pointer came down
  #pinch = 0;
  #engaged = false; // the element has been clicked, and the pointer has not left it since

  constructor(stage: HTMLElement, camera: OrbitCamera, picture: PictureBox, host: ControlsHost) {
    this.#stage = stage;
    this.#camera = camera;
    this.#picture = picture;
    this.#host = host;
    const { signal } = this.#abort;
    stage.addEventListener('pointerdown', (e) => this.#down(e), { signal });
    stage.addEventListener('pointermove', (e) => this.#move(e), { signal });
    for (const type of ['pointerup', 'pointercancel', 'lostpointercapture'] as const) {
      stage.addEventListener(type, (e) => this.#up(e), { signal });
    }
    stage.addEventListener('pointerleave', () => { this.#engaged = false; }, { signal });
    stage.addEventListener('wheel', (e) => this.#wheel(e), { signal, passive: false });
    stage.addEventListener('dblclick', () => this.#recentre(), { signal });
    stage.addEventListener('keydown', (e) => this.#key(e), { signal });
  }

  dispose(): void {
    this.#abort.abort();
    this.#pointers.clear();
  }
  get dragging(): boolean {
    return this.#pointers.size > 0;
  }

  #down(e: PointerEvent): void {
    if (!this.#host.orbits() || (e.pointerType === 'mouse' && e.button !== 0) || this.#pointers.size >= 2) return;
    if (!this.#pointers.size) this.#corners = this.#picture.corners();
    this.#pointers.set(e.pointerId, this.#placeOf(e));
    this.#engaged = true;
    try {
      this.#stage.setPointerCapture(e.pointerId);
    } catch {
      // the pointer is up already: without capture, moves inside the element still count
    }
    this.#pinch = this.#spread();
    this.#host.onInteract();
  }

  #move(e: PointerEvent): void {
    const last = this.#pointers.get(e.pointerId);
    if (!last) return;
    const now = this.#placeOf(e);
    this.#pointers.set(e.pointerId, now);
    if (this.#pointers.size === 1) {
      const degrees = this.#host.sensitivity().orbit * DRAG_DEG_PER_HEIGHT;
      this.#camera.rotate((last.x - now.x) * degrees, (now.y - last.y) * degrees);
    } else {
      const spread = this.#spread();
      if (this.#pinch > 0 && spread > 0) this.#zoom(this.#pinch / spread);
      this.#pinch = spread;
    }
    this.#host.onInteract();
  }

  #placeOf({ clientX, clientY }: PointerEvent): Point {
    const { width, height } = this.#picture.size, { x, y } = pointInBox(this.#corners!, { x: clientX, y: clientY });
    return { x: (x * width) / height, y };
  }

  #up(e: PointerEvent): void {
    this.#pointers.delete(e.pointerId);
    this.#pinch = this.#spread();
  }

  #recentre(): void {
    if (!this.#host.orbits()) return;
    this.#camera.reset();
    this.#host.onInteract();
  }
  #zoom(factor: number): void {
    const { zoom } = this.#host.sensitivity();
    if (zoom) this.#camera.zoom(factor ** zoom); // at 0 no call: it would fix an automatic distance
  }

  #spread(): number {
    const [a, b] = [...this.#pointers.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  #wheel(e: WheelEvent): void {
    if (!this.#host.orbits() || !this.#host.sensitivity().zoom || !(e.ctrlKey || this.#engaged || this.#host.wheelZooms())) return;
    e.preventDefault();
    const pixels = e.deltaY * (e.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1);
    this.#zoom(Math.exp(Math.max(-200, Math.min(200, pixels)) * (e.ctrlKey ? 0.008 : 0.0015)));
    this.#host.onInteract();
  }

  #key(e: KeyboardEvent): void {
    if (e.altKey || e.ctrlKey || e.metaKey) return;
    if (e.key === ' ') {
      this.#host.togglePlay();
      e.preventDefault();
      return;
    }
    const action = this.#actions()[e.key];
    if (!action || !this.#host.orbits()) return;
    action();
    e.preventDefault();
    this.#host.onInteract();
  }

  #actions(): Record<string, () => void> {
    const camera = this.#camera;
    return {
      ArrowLeft: () => camera.rotate(-KEY_STEP_DEG, 0),
      ArrowRight: () => camera.rotate(KEY_STEP_DEG, 0),
      ArrowUp: () => camera.rotate(0, KEY_STEP_DEG),
      ArrowDown: () => camera.rotate(0, -KEY_STEP_DEG),
      '+': () => this.#zoom(1 / KEY_ZOOM),
      '=': () => this.#zoom(1 / KEY_ZOOM),
      '-': () => this.#zoom(KEY_ZOOM),
      Home: () => camera.reset(),
    };
  }
}
