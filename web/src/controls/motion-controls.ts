// SPDX-License-Identifier: Apache-2.0
// Turns keys and a touch joystick into steering: left and right turn, up and down change the parameter, Space acts. The host turns
// steering into motion.
import { adopt } from '../page/documents.js';

const KEYS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0], KeyA: [-1, 0], ArrowRight: [1, 0], KeyD: [1, 0],
  ArrowUp: [0, 1], KeyW: [0, 1], ArrowDown: [0, -1], KeyS: [0, -1],
};
const CSS = `
.joystick { position: absolute; left: 16px; bottom: 16px; width: 112px; height: 112px; border-radius: 50%; touch-action: none;
  background: rgba(127,127,127,.18); border: 1px solid rgba(127,127,127,.35); box-sizing: border-box; }
.joystick > div { position: absolute; left: 32px; top: 32px; width: 46px; height: 46px; border-radius: 50%;
  background: rgba(20,20,24,.55); }
@media (forced-colors: active) { .joystick > div { background: ButtonText; } }
@media (hover: hover) and (pointer: fine) { .joystick { display: none; } }
`;
const DEAD_ZONE = 0.12; // share of the joystick's radius

export interface MotionHost {
  /** Returns true if keys and joystick steer the character; then the arrow keys do not turn the orbit. */
  steers(): boolean;
  /** Called for Space and for a tap on the joystick. */
  act(): void;
  onInteract(): void;
}

export interface Steering {
  /** Turn: -1 left … 1 right. */
  turn: number;
  /** Change of the parameter by held keys: -1 down … 1 up. */
  change: number;
  /** Goal of the parameter by the joystick, 0 … 1 of its range; null while the joystick is not held. */
  level: number | null;
}

export class MotionControls {
  readonly #host: MotionHost;
  readonly #joystick = document.createElement('div');
  readonly #knob = document.createElement('div');
  readonly #abort = new AbortController();
  readonly #held = new Set<string>();
  #stick: { id: number; x: number; y: number; moved: boolean } | null = null;

  /** Inserts the joystick after `stage` in its shadow tree. */
  constructor(stage: HTMLElement, host: MotionHost) {
    this.#host = host;
    const joystick = this.#joystick;
    for (const [name, element] of Object.entries({ joystick, knob: this.#knob })) {
      element.className = name;
      element.setAttribute('part', name);
    }
    joystick.setAttribute('aria-hidden', 'true'); // the keys steer as well
    joystick.append(this.#knob);
    adopt(stage, CSS);
    stage.after(joystick);
    this.update();
    const { signal } = this.#abort;
    stage.addEventListener('keydown', (e) => this.#key(e, true), { signal, capture: true });
    stage.addEventListener('keyup', (e) => this.#key(e, false), { signal, capture: true });
    stage.addEventListener('blur', () => this.#held.clear(), { signal });
    joystick.addEventListener('pointerdown', (e) => this.#grab(joystick, e), { signal });
    joystick.addEventListener('pointermove', (e) => this.#drag(joystick, e), { signal });
    for (const type of ['pointerup', 'pointercancel', 'lostpointercapture'] as const) {
      joystick.addEventListener(type, (e) => this.#release(e), { signal });
    }
  }

  /** Shows the joystick if it can steer, else hides it. */
  update(): void { this.#joystick.hidden = !this.#host.steers(); }

  dispose(): void {
    this.#abort.abort();
    this.#joystick.remove();
    this.#held.clear();
    this.#stick = null;
  }

  get steering(): Steering | null {
    if (!this.#host.steers()) return null;
    let [turn, change] = [0, 0];
    for (const code of this.#held) {
      turn += KEYS[code]![0];
      change += KEYS[code]![1];
    }
    const stick = this.#stick?.moved ? this.#stick : null;
    if (stick) turn += Math.abs(stick.x) < DEAD_ZONE ? 0 : stick.x;
    return { turn: Math.max(-1, Math.min(1, turn)), change, level: stick ? (1 - stick.y) / 2 : null };
  }

  #key(e: KeyboardEvent, down: boolean): void {
    if (!this.#host.steers() || (down && (e.altKey || e.ctrlKey || e.metaKey))) return;
    if (e.code === 'Space') {
      if (down && !e.repeat) this.#host.act();
    } else if (KEYS[e.code]) {
      if (down) this.#held.add(e.code);
      else this.#held.delete(e.code);
    } else {
      return;
    }
    e.preventDefault();
    e.stopImmediatePropagation();
    this.#host.onInteract();
  }

  #grab(joystick: HTMLElement, e: PointerEvent): void {
    if (this.#stick) return;
    joystick.setPointerCapture(e.pointerId);
    this.#stick = { id: e.pointerId, x: 0, y: 0, moved: false };
    this.#drag(joystick, e);
    e.stopPropagation();
  }

  #drag(joystick: HTMLElement, e: PointerEvent): void {
    if (this.#stick?.id !== e.pointerId) return;
    const box = joystick.getBoundingClientRect();
    const radius = box.width / 2;
    let x = (e.clientX - box.left - radius) / radius;
    let y = (e.clientY - box.top - radius) / radius;
    const length = Math.hypot(x, y);
    if (length > 1) [x, y] = [x / length, y / length];
    const moved = this.#stick.moved || length > DEAD_ZONE;
    this.#stick = { id: e.pointerId, x, y, moved };
    const reachPx = 0.3 * joystick.offsetWidth; // layout size: the page's transforms apply to the translation, too
    this.#knob.style.transform = `translate(${x * reachPx}px, ${y * reachPx}px)`;
    this.#host.onInteract();
    e.stopPropagation();
  }

  #release(e: PointerEvent): void {
    if (this.#stick?.id !== e.pointerId) return;
    const tapped = !this.#stick.moved && e.type === 'pointerup';
    this.#stick = null;
    this.#knob.style.transform = '';
    if (tapped) this.#host.act();
    this.#host.onInteract();
  }
}
