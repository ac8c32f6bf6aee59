// SPDX-License-Identifier: Apache-2.0
// Reads and writes fields of records in wasm memory, by type and offset: little-endian; texts and bytes are stored as
// address and length. generated/abi.ts lists each record's fields and offsets.
const decoder = new TextDecoder();

export class Reader {
  readonly #memory: Uint8Array;
  readonly #view: DataView;

  /** `at`: address of a record. Texts are copied; bytes are a view that is valid until the next call into wasm. */
  constructor(memory: Uint8Array, at: number) {
    this.#memory = memory;
    this.#view = new DataView(memory.buffer, at);
  }
  i32(at: number): number { return this.#view.getInt32(at, true); }
  u32(at: number): number { return this.#view.getUint32(at, true); }
  f64(at: number): number { return this.#view.getFloat64(at, true); }
  f64s(at: number, count: number): number[] { return Array.from({ length: count }, (_, i) => this.f64(at + 8 * i)); }
  bool(at: number): boolean { return this.i32(at) !== 0; }
  bytes(at: number): Uint8Array {
    const start = this.u32(at);
    return this.#memory.subarray(start, start + this.u32(at + 4));
  }
  text(at: number): string { return decoder.decode(this.bytes(at)); }
}

export class Writer {
  readonly bytes: Uint8Array;
  readonly #view: DataView;

  constructor(size: number) {
    this.bytes = new Uint8Array(size);
    this.#view = new DataView(this.bytes.buffer);
  }
  i32(at: number, value: number): void { this.#view.setInt32(at, value, true); }
  u32(at: number, value: number): void { this.#view.setUint32(at, value, true); }
  f64(at: number, value: number): void { this.#view.setFloat64(at, value, true); }
  f64s(at: number, values: readonly number[]): void { values.forEach((value, i) => this.f64(at + 8 * i, value)); }
  bool(at: number, value: boolean): void { this.i32(at, value ? 1 : 0); }
}
