// SPDX-License-Identifier: Apache-2.0
// Interface of a session for fourdvt-more.js. Each of the two scripts has its own copies of classes, so that they share
// objects by these types alone.
import type { UploadPath } from '../decode/upload-path.js';
import type { Transport } from '../net/transport.js';
import type { ErrorDetail } from '../report/errors.js';
import type { PlayerFiles } from '../wasm/files.js';
import type { PlayerCall, TurnHook, WasmModule } from '../wasm/wasm-abi.js';

export type SideFiles = Pick<Transport, 'range' | 'stopReplay'>;

export interface SidePlayer {
  call(action: PlayerCall): void;
  /** Returns the texture that the page fills with the room's picture and its mipmaps. bytes: the picture's file. */
  showRoom(bytes: Uint8Array): WebGLTexture;
  hideRoom(): void;
  invalidateState(): void;
  /** Called when the second part is loaded. */
  moreCame(): void;
  judgeRendition(sequence: number, rendition: number, plays: boolean): void;
  lookAhead(atOnce: boolean): void;
}

export interface SideActor {
  readonly player: SidePlayer | null;
  readonly character: { roomUri: string; roomBytes: number } | null;
  run(action: (player: SidePlayer) => void): unknown;
  /** Passes the next picture that WebCodecs decodes to `action`, which must close it. */
  takeFrame(action: (frame: VideoFrame) => void): void;
  setHook(hook: TurnHook): void;
  wake(): void;
  dispose(): void;
}

/** Commands of one character. */
export interface SideCommands {
  readonly settings: { readonly align: string; readonly playing: boolean };
  /** Changes one setting; false, after an error event, if the character refuses it. */
  set(name: 'align' | 'playing', value: string | boolean): boolean;
}

/** Another character for the main one's canvas, loaded or not. */
export interface SideCompanion {
  readonly commands: SideCommands;
  /** Address of its character.gltf; null: the main character's. */
  readonly src: string | null;
  /** Aborted when the companion leaves. */
  readonly left: AbortSignal;
  emit(name: string, detail?: unknown): void;
}

export interface ActorHost {
  emit(name: string, detail?: unknown): void;
  /** Requests a turn of the frame loop. */
  wake(): void;
  /** Called if the upload path cannot read the pictures' planes. */
  onNoPlanes(): void;
  /** Loads the second part of the player. */
  more(): Promise<unknown>;
  /** Called for a trap in wasm or another error that ends the whole session. */
  fatal(reason: unknown): void;
}

/** A bake that a character is loaded from. */
export interface Bake {
  transport: Transport;
  manifest: unknown;
  /** Content of the bake's start file; empty if there is none. */
  start: Uint8Array;
}

export interface SessionSide {
  readonly options: { readonly src: string; readonly files: PlayerFiles };
  readonly host: { readonly element: Element; readonly commands: SideCommands; emit(name: string, detail?: unknown): void };
  /** Aborted when the session ends. */
  readonly signal: AbortSignal;
  readonly module: WasmModule;
  readonly gl: WebGL2RenderingContext;
  /** Actor of the main character; null while it is being loaded or replaced. */
  readonly main: SideActor | null;
  readonly manifest: unknown;
  readonly transport: SideFiles;
  /** True if the bake was loaded past the browser's cache. */
  readonly fresh: boolean;
  readonly path: UploadPath;
  /** Alignment set by the page; until flow is loaded, the commands have another. */
  align: string;
  /** True if the character's room is to be drawn. */
  readonly room: boolean;
  readonly drawing: { shown: boolean; programsMissing: boolean };
  readonly network: (waiting: boolean) => void;
  openTransport(src: string, cache: RequestCache): Transport;
  /** Creates the actor of another character in the main one's canvas; it must not outlive the main one. */
  makeActor(bake: Bake, commands: SideCommands, host: ActorHost): SideActor;
  more(): Promise<unknown>;
  /** Opens another bake of the character, or the same one again, and continues at the present state. */
  reopen(path: UploadPath, bake?: Partial<Bake>): void;
  /** Continues on the upload path that was measured as the fastest. */
  settle(path: UploadPath): Promise<void>;
  wake(): void;
  /** Returns the detail of the error event for an exception. */
  errorOf(reason: unknown): ErrorDetail;
  /** Handles an event of the main character's player. */
  onMainEvent(name: string, detail?: unknown): void;
  /** Ends the session with an error event. */
  fatal(reason: unknown): void;
  end(error: ErrorDetail): void;
}
