// SPDX-License-Identifier: Apache-2.0
// Interface between a session and the element that creates it.
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
  /** True: bypasses the browser's cache. */
  fresh: boolean;
  credentials: RequestCredentials;
  signer: NonNullable<RequestOptions['signer']>;
}

/** Members of the element's overlay that a session uses. */
export interface Display {
  /** Shows this canvas in place of the last one. */
  showCanvas(canvas: HTMLCanvasElement): void;
  /** Covers the canvas with a copy of its picture until the next picture, which is of a higher rendition. */
  cover(): void;
  /** Shows that the second part cannot be loaded and the character plays without it. */
  incomplete(error: ErrorDetail): void;
}

export interface SessionHost {
  /** Element whose attributes define the characters' look. */
  readonly element: Element;
  readonly overlay: Display;
  readonly camera: OrbitCamera;
  /** Commands of the main character. */
  readonly commands: Commands;
  /** All companions that have joined, loaded or not. */
  readonly companions: Iterable<Companion>;
  /** Called per turn before drawing; returns true if the view or the motion changes by itself. */
  animate(stepS: number): boolean;
  emit(name: string, detail?: unknown): void;
  firstPicture(): void;
  /** Called when a picture of another frame or placement has been drawn; for the first one, before firstPicture. */
  picture(): void;
  /** Called when waiting for the network begins, and when it ends. */
  network(waiting: boolean): void;
  /** Called if a step takes long, and with null once it progresses. */
  stalled(step: Step | null): void;
  /** Called, possibly more than once, when the player's second part is loaded. */
  more(more: More): void;
  /** Called when the session has ended by loss of the GL context; `restored` follows if the browser restores it. */
  lost(session: object): void;
  /** Called when the context is restored; returns true if a new session replaces the ended one. */
  restored(session: object): boolean;
  /** Called when the session has ended because the shared player has trapped in another viewer's call. */
  trapped(session: object): void;
}

export interface Snapshot {
  /** Width and height, pixels; default: the viewer's. */
  width?: number;
  height?: number;
  /** Fields that differ from the present view; or azimuth, elevation and distance in the format of `camera-orbit`. */
  pose?: Partial<OrbitPose> | string;
}
