// SPDX-License-Identifier: Apache-2.0
// Types that a session and the element that makes it share.
import type { OrbitCamera } from '../camera/orbit-camera.js';
import type { UploadChoice } from '../decode/upload-path.js';
import type { RequestOptions } from '../net/transport.js';
import type { Commands } from '../player/commands.js';
import type { More } from '../player/wasm-module.js';
import type { Align, OrbitPose } from '../player/wasm-player.js';
import type { ErrorDetail } from '../report/errors.js';
import type { Step } from '../report/watchdog.js';
import type { PlayerFiles } from '../wasm/files.js';
import type { Companion } from './companion.js';

export interface SessionOptions {
  src: string;
  files: PlayerFiles;
  uploadPath: UploadChoice;
  align: Align;
  room: boolean;
  /** Past the browser's cache. */
  fresh: boolean;
  credentials: RequestCredentials;
  signer: NonNullable<RequestOptions['signer']>;
}

/** The element's shadow tree. */
export interface Display {
  /** Shows this canvas in place of any before. */
  showCanvas(canvas: HTMLCanvasElement): void;
  /** Covers the canvas with its present picture until the next one, which is of a higher rendition. */
  cover(): void;
  /** The second part cannot be loaded: the character plays without it. */
  incomplete(error: ErrorDetail): void;
}

export interface SessionHost {
  /** Its attributes have the look of the characters. */
  readonly element: Element;
  readonly overlay: Display;
  readonly camera: OrbitCamera;
  /** The main character's. */
  readonly commands: Commands;
  /** All that have joined, loaded or not. */
  readonly companions: Iterable<Companion>;
  /** Called once per frame before drawing. True if the view or the motion changes by itself. */
  animate(stepS: number): boolean;
  emit(name: string, detail?: unknown): void;
  firstPicture(): void;
  /** Called at each picture that is drawn for another frame or place; the first comes before firstPicture. */
  picture(): void;
  /** Called when waiting for the network begins, and when it ends. */
  network(waiting: boolean): void;
  /** Called if a step takes long; null: it goes on. */
  stalled(step: Step | null): void;
  /** The player's second part is there. Called once or more. */
  more(more: More): void;
  /** The session has ended with the stage, whose context is lost; `restored` follows if the browser gives it back. */
  lost(session: object): void;
  /** True if a session takes its place. */
  restored(session: object): boolean;
  /** The session has ended because the player has trapped in another viewer's call. */
  trapped(session: object): void;
}

export interface Snapshot {
  /** Pixels; without: those of the viewer. */
  width?: number;
  height?: number;
  /** The parts that differ from the view that is shown; or azimuth, elevation and distance as `camera-orbit` has them. */
  pose?: Partial<OrbitPose> | string;
}
