// SPDX-License-Identifier: Apache-2.0
// Interface of a session for fourdvt-more.js, which has its own copies of classes: the two scripts share objects by these types alone.
import type { UploadPath } from '../decode/upload-path.js';
import type { Transport } from '../net/transport.js';
import type { ErrorDetail } from '../report/errors.js';
import type { PlayerFiles } from '../wasm/files.js';
import type { PlayerCall, TurnHook, WasmModule } from '../wasm/wasm-abi.js';

export type SideFiles = Pick<Transport, 'range' | 'stopReplay'>;

export interface SidePlayer {
  call(action: PlayerCall): void;
  /** A texture that the page fills with the room's picture, and its mipmaps. */
  showRoom(bytes: Uint8Array): WebGLTexture;
  hideRoom(): void;
  invalidateState(): void;
  /** The second part is there. */
  moreCame(): void;
  judgeRendition(sequence: number, rendition: number, plays: boolean): void;
  lookAhead(atOnce: boolean): void;
}

export interface SideActor {
  readonly player: SidePlayer | null;
  readonly character: { roomUri: string; roomBytes: number } | null;
  run(action: (player: SidePlayer) => void): unknown;
  /** Gives the next picture that WebCodecs decodes; `action` closes it. */
  takeFrame(action: (frame: VideoFrame) => void): void;
  setHook(hook: TurnHook): void;
  wake(): void;
  dispose(): void;
}

/** Commands of one character. */
export interface SideCommands {
  readonly settings: { readonly align: string; readonly playing: boolean };
  /** False, after an error event, if the character refuses it. */
  set(name: 'align' | 'playing', value: string | boolean): boolean;
}

/** A character to be drawn beside the main one. */
export interface SideCompanion {
  readonly commands: SideCommands;
  /** Null: the main character's. */
  readonly src: string | null;
  /** Aborted when it leaves. */
  readonly left: AbortSignal;
  emit(name: string, detail?: unknown): void;
}

export interface ActorHost {
  emit(name: string, detail?: unknown): void;
  /** Requests a turn of the frame loop. */
  wake(): void;
  /** Reports that this upload path cannot show the video's pictures. */
  onNoPlanes(): void;
  /** Loads the second part of the player. */
  more(): Promise<unknown>;
  /** Reports a trap in wasm or another error that ends the whole session. */
  fatal(reason: unknown): void;
}

/** A bake that a character is loaded from. */
export interface Bake {
  transport: Transport;
  manifest: unknown;
  /** The bytes of its start file, or none. */
  start: Uint8Array;
}

export interface SessionSide {
  readonly options: { readonly src: string; readonly files: PlayerFiles };
  readonly host: { readonly element: Element; readonly commands: SideCommands; emit(name: string, detail?: unknown): void };
  /** Aborted when the session ends. */
  readonly signal: AbortSignal;
  readonly module: WasmModule;
  readonly gl: WebGL2RenderingContext;
  /** Null while it is loaded, or replaced. */
  readonly main: SideActor | null;
  readonly manifest: unknown;
  readonly transport: SideFiles;
  /** It was loaded past the browser's cache. */
  readonly fresh: boolean;
  readonly path: UploadPath;
  /** Alignment that the page has set; the commands have the one that applies until flow is loaded. */
  align: string;
  /** The character's room is to be drawn. */
  readonly room: boolean;
  readonly drawing: { shown: boolean; programsMissing: boolean };
  readonly network: (waiting: boolean) => void;
  openTransport(src: string, cache: RequestCache): Transport;
  /** Another character in the main one's canvas, which it must not outlive. */
  makeActor(bake: Bake, commands: SideCommands, host: ActorHost): SideActor;
  more(): Promise<unknown>;
  /** Opens another bake of the character, or the same one; it goes on from where it is. */
  reopen(path: UploadPath, bake?: Partial<Bake>): void;
  /** Goes on by the upload path that the main character's pictures have shown to be the best. */
  settle(path: UploadPath): Promise<void>;
  wake(): void;
  /** Detail of an error event for a reason. */
  errorOf(reason: unknown): ErrorDetail;
  /** Handles an event of the main character's player. */
  onMainEvent(name: string, detail?: unknown): void;
  /** Ends the session with an error event. */
  fatal(reason: unknown): void;
  end(error: ErrorDetail): void;
}
