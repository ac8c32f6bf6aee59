// SPDX-License-Identifier: Apache-2.0
// <fourdvt-character> inside <fourdvt-viewer>: one more character in the same canvas. It shares shader programs and
// render targets with the others and has its own decoders. It loads after the viewer's own character, plays and pauses
// with it, and keeps its state over the loss of a GL context.
import { isOn, upgradeProperties } from '../page/attributes.js';
import { Commands } from '../player/commands.js';
import type { Placement } from '../player/wasm-player.js';
import { asViewerError, characterAddress, dispatch, PageElement } from '../report/errors.js';
import { JOIN_EVENT, type Companion } from '../session/companion.js';

export class FourdvtCharacter extends PageElement {
  static readonly observedAttributes = ['src', 'sequence', 'position', 'heading', 'travel'];
  readonly #commands = new Commands();
  #membership: AbortController | null = null; // aborted when the element leaves its document; null outside
  #viewer: Element | null = null;

  connectedCallback(): void {
    if (this.#membership) return; // moved within the page
    this.#commands.begin({
      sequence: this.getAttribute('sequence'),
      travel: isOn(this, 'travel'),
      placement: this.#placeOfAttributes(),
    });
    upgradeProperties(this);
    this.#join();
  }
  disconnectedCallback(): void {
    queueMicrotask(() => {
      if (this.isConnected && this.closest('fourdvt-viewer') === this.#viewer) return;
      this.#membership?.abort();
      this.#membership = null;
      if (this.isConnected) this.connectedCallback();
    });
  }
  attributeChangedCallback(name: string, before: string | null, value: string | null): void {
    if (before === value || !this.#membership) return;
    if (name === 'src') this.#changeSource();
    else if (name === 'sequence') { if (value) this.goTo(value); }
    else if (name === 'travel') this.#commands.set('travel', isOn(this, 'travel'));
    else this.placement = this.#placeOfAttributes();
  }

  goTo(state: string): void { this.#commands.goTo(state); }
  setParameter(name: string, value: number, immediate = false): void {
    this.#commands.setParameter(name, value, immediate);
  }
  get placement(): Placement { return this.#commands.placement; }
  set placement(place: Partial<Placement>) { this.#commands.place(place); }
  get heading(): number { return this.placement.heading; }
  set heading(degrees: number) { this.#commands.steer(degrees); }
  /** True when the character is loaded and shown. */
  get present(): boolean { return this.#commands.state()?.hasFrame ?? false; }

  #join(): void {
    const { signal } = (this.#membership = new AbortController());
    this.#viewer = this.closest('fourdvt-viewer');
    const src = this.getAttribute('src');
    if (src === '') return;
    const emit = (name: string, detail?: unknown): void => dispatch(this, name, detail);
    let address: string | null = null;
    try {
      if (src !== null) address = characterAddress(src, this.baseURI);
    } catch (reason) {
      return queueMicrotask(() => emit('error', asViewerError(reason).detail)); // a listener may be added after src
    }
    const companion: Companion = { commands: this.#commands, src: address, left: signal, emit };
    this.dispatchEvent(new CustomEvent(JOIN_EVENT, { bubbles: true, detail: companion }));
  }

  // Replaces the character; the new one keeps the old one's placement.
  #changeSource(): void {
    const { placement } = this;
    this.#membership?.abort();
    this.#commands.begin({ placement });
    this.#join();
  }

  /** Reads the attributes position="x z", metres, and heading, degrees. */
  #placeOfAttributes(): Placement {
    const [x, z] = (this.getAttribute('position') ?? '').trim().split(/\s+/).map(Number);
    const heading = Number(this.getAttribute('heading'));
    const finite = (value: number | undefined): number => (value !== undefined && Number.isFinite(value) ? value : 0);
    return { x: finite(x), z: finite(z), heading: finite(heading) };
  }
}
