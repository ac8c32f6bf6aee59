// SPDX-License-Identifier: Apache-2.0
// Draws the characters of one viewer in the turns of a frame loop, and makes snapshots. Does not load or decode anything.
import { parseOrbit } from '../camera/orbit-camera.js';
import { DrawPace } from '../page/frame-loop.js';
import { checkSnapshot, MAX_CANVAS_SIDE } from '../player/input-checks.js';
import type { OrbitPose } from '../player/wasm-player.js';
import type { Actor } from './actor.js';
import type { SessionHost, Snapshot } from './session-host.js';
import type { StageSlot, Stage } from './stage.js';

const FOLLOW_S = 1; // time drawn on after the last change: six settling times of montage4d (native/render/method.h)

export interface DrawingHost {
  /** Characters to draw, the main one first; empty before that is loaded. */
  actors(): Actor[];
  /** Stage; call only while there is an actor. */
  stage(): Stage;
  readonly slot: StageSlot;
  firstPicture(): void;
  picture(): void;
  /** Reports a failed draw. */
  drawFailed(reason: unknown): void;
}

export class Drawing {
  readonly #view: Pick<SessionHost, 'element' | 'camera' | 'animate'>;
  readonly #host: DrawingHost;
  readonly #pace = new DrawPace();
  #size = { width: 1, height: 1 };
  #redraw = true;
  #drawn = '';
  #changedS = 0; // time of the last change of the picture, on the loop's clock
  /** True if later pictures need shader programs that are not compiled yet. */
  programsMissing = true;
  /** True once a picture has been drawn. */
  shown = false;

  constructor(view: Pick<SessionHost, 'element' | 'camera' | 'animate'>, host: DrawingHost) {
    this.#view = view;
    this.#host = host;
  }

  resize(width: number, height: number): void {
    const scale = Math.min(1, MAX_CANVAS_SIDE / Math.max(width, height, 1));
    this.#size = { width: Math.max(1, Math.round(width * scale)), height: Math.max(1, Math.round(height * scale)) };
  }
  /** Makes the next turn draw. */
  invalidate(): void { this.#redraw = true; }
  /** Resets the record of the last drawn state, for another main character. */
  forget(): void { this.#drawn = ''; }

  /** Runs a turn of the frame loop; returns true while further turns are needed. */
  turn(clockS: number, stepS: number): boolean {
    for (const actor of this.#host.actors()) actor.tick(clockS);
    const moved = this.#view.animate(stepS);
    const actors = this.#host.actors();
    const states = actors.map((actor) => actor.state());
    const [state] = states; // the main character's
    if (!state) return false;
    this.#view.camera.follow(state);
    const serial = states.map((s) => s && [s.framesShown, s.frame, s.x, s.z, s.heading]).join();
    const changed = moved || this.#redraw || serial !== this.#drawn;
    if (changed) this.#changedS = clockS;
    // A method with temporal state must be drawn every turn: it takes the time between ticks for that between pictures.
    const following = this.#view.element.matches('[method^=montage4d]') && clockS - this.#changedS < FOLLOW_S;
    // Compiles one program per turn after the first picture: neither that nor the first use of a slider waits for all.
    if (this.shown && state.hasFrame && this.programsMissing) this.programsMissing = actors[0]!.makeNextProgram();
    if ((changed || following) && state.hasFrame) {
      const picture = this.#redraw || following || serial !== this.#drawn;
      this.#redraw = !this.#pace.takes(stepS, picture);
      if (!this.#redraw) this.#show(serial);
    }
    return moved || following || actors.some((actor, i) => states[i] && actor.busy(states[i]!));
  }

  /**
   * Makes a PNG of the shown frame, at the snapshot's size and pose if given; null before the first picture. Rejects
   * with a TypeError or RangeError for an invalid snapshot, or the player's error. Keeps the shown picture.
   */
  async toBlob(snapshot?: Snapshot): Promise<Blob | null> {
    const { width = this.#size.width, height = this.#size.height, pose: wanted } = snapshot ?? {}, { pose: shown } = this.#view.camera;
    const part = typeof wanted === 'string' ? parseOrbit(wanted) : wanted;
    const pose: OrbitPose = { ...shown, ...part, distance: part?.distance ?? shown.distance };
    if (snapshot) checkSnapshot(width, height, pose);
    if (!this.#host.actors()[0]?.state()?.hasFrame) return null;
    try {
      this.#paint(width, height, pose);
      return this.#host.stage().toBlob(this.#host.slot, width, height);
    } finally {
      this.redraw();
    }
  }

  /** Draws the shown frame again, at once. */
  redraw(): void {
    if (this.#host.actors()[0]?.state()?.hasFrame) this.#draw();
  }

  #show(serial: string): void {
    if (!this.#draw()) return;
    if (this.#drawn !== serial) this.#host.picture();
    this.#drawn = serial;
    if (this.shown) return;
    this.shown = true;
    this.#host.firstPicture();
  }

  // Draws into the context's canvas. Requires a frame of the main character.
  #paint(width: number, height: number, pose: OrbitPose): void {
    const [main, ...others] = this.#host.actors().filter((actor) => actor.state()?.hasFrame);
    if (!main) return;
    this.#host.stage().fit(this.#host.slot, width, height);
    main.player?.draw(pose, width, height, others.map((actor) => actor.player!));
  }
  // Draws and presents; returns false, after an error event, if the player fails.
  #draw(): boolean {
    const { width, height } = this.#size;
    try {
      this.#paint(width, height, this.#view.camera.pose);
      if (!this.#host.actors().length) return false;
      this.#host.stage().present(this.#host.slot, width, height);
      return true;
    } catch (reason) {
      this.#host.drawFailed(reason);
      return false;
    }
  }
}
