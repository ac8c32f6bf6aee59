// SPDX-License-Identifier: Apache-2.0
// Carries out the player's decode requests with WebCodecs. Holds a bounded number of pictures, in presentation order,
// until the player has a slot for them. Upload path 'i420' copies the pixels (I420 or NV12 planes) into the player's
// memory and then closes the VideoFrame; path 'rgba' holds the VideoFrame itself.
import type { DecoderFault, PictureKind } from '../wasm/generated/abi.js';

const MAX_HELD = 1;   // pictures that wait for a slot; while there are so many the decoder gets no samples
const MAX_QUEUED = 6; // samples queued in the decoder

export interface Planes {
  width: number;
  height: number;
  /** Offset and stride of each plane; an NV12 picture has two. */
  layout: { offset: number; stride: number }[];
}

export type Picture =
  | { kind: 'i420'; timestampUs: number; block: number; planes: Planes }
  | { kind: 'rgba'; timestampUs: number; frame: VideoFrame }
  | { kind: 'video'; timestampUs: number; video: HTMLVideoElement };

/** Access to the player's memory. */
export interface Heap {
  /** Returns a block's address; 0 if the player has trapped, for example out of memory: its session ends. */
  allocate(bytes: number): number;
  free(block: number): void;
  /** Returns a view of a block, valid until the memory grows. */
  bytes(block: number, length: number): Uint8Array;
}

/** Carries out the decode requests of one of the player's decoders. */
export interface PictureDecoder {
  configure(codec: string, description: Uint8Array, width: number, height: number): void;
  /** Queues a sample. wanted: false if it is decoded only as a reference of later pictures: its own is dropped. */
  decode(bytes: Uint8Array, timestampUs: number, key: boolean, wanted: boolean): void;
  flush(): void;
  reset(): void;
  dispose(): void;
  /** Feeds queued samples on. pace: pictures a second that the player takes at present; 0: only a sought one. */
  feed(pace: number): void;
  /** Returns the earliest of the waiting pictures. */
  peek(): Picture | undefined;
  /** Removes the earliest waiting picture. taken: the player has it, and frees its block if it has one. */
  shift(taken: boolean): void;
  readonly busy: boolean;
  /** Step of the decoder that the next picture waits for; null: none. */
  readonly missing: 'decoder' | 'upload' | null;
  /** Number of pictures decoded so far. */
  readonly given: number;
}

export interface DecoderCallbacks {
  onPicture(): void;
  /** Reports that the picture's planes cannot be read (opaque GPU frame): only path 'rgba' can show it. */
  onNoPlanes(): void;
  /** Reports a fault: the decoder is closed until it is configured again. */
  onFault(fault: DecoderFault, reason: string): void;
  /** Called with every picture of WebCodecs; does not close it. */
  onFrame(frame: VideoFrame): void;
}

type Command = { chunk: EncodedVideoChunk } | 'flush';

export class FrameDecoder implements PictureDecoder {
  readonly #path: PictureKind;
  readonly #heap: Heap;
  readonly #callbacks: DecoderCallbacks;
  #decoder: VideoDecoder | null = null;
  #config: VideoDecoderConfig | null = null;
  #commands: Command[] = [];
  #frames: VideoFrame[] = [];
  #pictures: Picture[] = [];
  readonly #unwanted = new Set<number>(); // timestamps of pictures that nothing waits for
  #copying: object | null = null; // the copy under way
  #inside = 0; // samples in the decoder without a picture yet
  given = 0;

  constructor(path: PictureKind, heap: Heap, callbacks: DecoderCallbacks) {
    this.#path = path;
    this.#heap = heap;
    this.#callbacks = callbacks;
  }

  configure(codec: string, description: Uint8Array, width: number, height: number): void {
    this.#forget();
    this.#config = { codec, codedWidth: width, codedHeight: height, optimizeForLatency: true };
    if (description.length) this.#config.description = description.slice();
    if (this.#decoder && this.#decoder.state !== 'closed') this.#decoder.close();
    // Firefox may call back after close(): errors are ignored, and pictures are closed.
    const decoder: VideoDecoder = new VideoDecoder({
      output: (frame) => (this.#decoder === decoder ? this.#onFrame(frame) : frame.close()),
      error: (reason) => {
        if (this.#decoder === decoder) this.#fail(reason);
      },
    });
    this.#decoder = decoder;
    try {
      decoder.configure(this.#config);
    } catch (reason) {
      this.#fail(new DOMException(String(reason), 'NotSupportedError'));
    }
  }

  decode(bytes: Uint8Array, timestampUs: number, key: boolean, wanted: boolean): void {
    if (!wanted) this.#unwanted.add(timestampUs);
    const chunk = new EncodedVideoChunk({ type: key ? 'key' : 'delta', timestamp: timestampUs, data: bytes });
    this.#commands.push({ chunk });
    this.feed();
  }
  flush(): void {
    this.#commands.push('flush');
    this.feed();
  }
  reset(): void {
    this.#forget();
    if (!this.#decoder || this.#decoder.state === 'closed' || !this.#config) return;
    this.#apply(() => {
      this.#decoder!.reset();
      this.#decoder!.configure(this.#config!);
    });
  }
  dispose(): void {
    this.#forget();
    if (this.#decoder && this.#decoder.state !== 'closed') this.#decoder.close();
    this.#decoder = null;
  }

  /** Passes samples to the decoder while there is room for their pictures. */
  feed(): void {
    const decoder = this.#decoder;
    while (decoder && decoder.state === 'configured' && this.#commands.length) {
      if (this.#frames.length + this.#pictures.length >= MAX_HELD || decoder.decodeQueueSize >= MAX_QUEUED) return;
      const command = this.#commands.shift()!;
      if (command === 'flush') decoder.flush().catch(() => undefined);
      else this.#apply(() => { decoder.decode(command.chunk); ++this.#inside; });
    }
  }

  peek(): Picture | undefined {
    return this.#pictures[0];
  }
  shift(taken: boolean): void {
    const picture = this.#pictures.shift();
    if (picture && !(taken && picture.kind === 'i420')) this.#release(picture);
    this.#copyNext();
    this.feed();
  }
  get missing(): 'decoder' | 'upload' | null {
    if (this.#copying) return 'upload';
    return this.#inside > 0 ? 'decoder' : null;
  }
  get busy(): boolean {
    return this.#commands.length + this.#frames.length > 0 || (this.#decoder?.decodeQueueSize ?? 0) > 0;
  }

  #release(picture: Picture): void {
    if (picture.kind === 'rgba') picture.frame.close();
    else if (picture.kind === 'i420') this.#heap.free(picture.block);
  }

  #onFrame(frame: VideoFrame): void {
    --this.#inside;
    ++this.given;
    if (this.#unwanted.delete(frame.timestamp)) {
      frame.close();
      this.feed();
      return;
    }
    this.#callbacks.onFrame(frame);
    if (this.#path === 'rgba') {
      this.#pictures.push({ kind: 'rgba', timestampUs: frame.timestamp, frame });
      this.#callbacks.onPicture();
    } else {
      this.#frames.push(frame);
      this.#copyNext();
    }
    this.feed();
  }

  #copyNext(): void {
    const frame = this.#frames[0];
    if (this.#copying || !frame || this.#pictures.length >= MAX_HELD) return;
    if (frame.format !== 'I420' && frame.format !== 'NV12') {
      this.#forget();
      this.#callbacks.onNoPlanes();
      return;
    }
    const size = frame.allocationSize();
    const block = this.#heap.allocate(size);
    if (!block) return;
    const copy = (this.#copying = {});
    const pixels = this.#heap.bytes(block, size);
    copyPlanes(frame, pixels).then(
      (layout) => {
        // Memory that has grown meanwhile has another buffer: copies again.
        const moved = pixels.buffer !== this.#heap.bytes(block, size).buffer;
        if (moved) this.#heap.free(block);
        this.#copied(copy, frame, moved ? 0 : block, layout);
      },
      () => {
        this.#heap.free(block);
        if (this.#copying !== copy) return;
        this.#forget();
        this.#callbacks.onNoPlanes();
      },
    );
  }

  // Ends a copy, and begins the next. block: address of the pixels; 0: the copy failed and is repeated.
  #copied(copy: object, frame: VideoFrame, block: number, layout: PlaneLayout[]): void {
    if (this.#copying !== copy) {
      if (block) this.#heap.free(block);
      return;
    }
    this.#copying = null;
    if (block) {
      const rect = frame.visibleRect!;
      const planes = { width: rect.width, height: rect.height, layout };
      this.#pictures.push({ kind: 'i420', timestampUs: frame.timestamp, block, planes });
      this.#frames.shift()!.close();
      this.#callbacks.onPicture();
      this.feed();
    }
    this.#copyNext();
  }

  #apply(action: () => void): void {
    try {
      action();
    } catch (reason) {
      this.#fail(reason);
    }
  }
  #fail(reason: unknown): void {
    this.#forget();
    if (this.#decoder && this.#decoder.state !== 'closed') this.#decoder.close();
    this.#decoder = null;
    const name = reason instanceof Error ? reason.name : '';
    const codec = this.#config?.codec ?? 'video';
    if (name === 'NotSupportedError') {
      this.#callbacks.onFault('unsupported', `this browser cannot decode ${codec}: bake a rendition with another codec`);
    } else {
      const message = `${codec}: ${reason instanceof Error ? reason.message : String(reason)}`;
      this.#callbacks.onFault(name === 'QuotaExceededError' ? 'taken-away' : 'samples', message); // WebCodecs: reclaimed
    }
  }
  #forget(): void {
    this.#copying = null;
    this.#inside = 0;
    this.#commands = [];
    this.#unwanted.clear();
    for (const frame of this.#frames) frame.close();
    this.#frames = [];
    for (const picture of this.#pictures) this.#release(picture);
    this.#pictures = [];
  }
}

// Copies the planes; async, so that a browser's synchronous exception is a rejection, too.
const copyPlanes = async (frame: VideoFrame, pixels: Uint8Array): Promise<PlaneLayout[]> => frame.copyTo(pixels);
