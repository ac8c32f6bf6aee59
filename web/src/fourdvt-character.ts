// SPDX-License-Identifier: Apache-2.0
// <fourdvt-character> inside <fourdvt-viewer>: one more character in the same canvas. Programs and targets are shared;
// each has decoders of its own. It comes when the viewer's own character is there, plays and pauses with it, and comes
// again, as it was, after a lost context.
import type { Actor, ActorWishes, Placement } from './actor.js';
import type { FourdvtViewer } from './fourdvt-viewer.js';

export class FourdvtCharacter extends HTMLElement {
  static readonly observedAttributes = ['src', 'sequence', 'position', 'heading', 'travel'];
  #viewer: FourdvtViewer | null = null;
  #actor: Actor | null = null;
  #coming = 0;
  #loading = false;
  #wishes: ActorWishes = {
    src: '', sequence: null, playing: true, loop: -1, rate: 1, frame: 0, parameters: new Map(), align: 'baked',
    travel: false, placement: { x: 0, z: 0, heading: 0 },
  };
  #listening: AbortController | null = null;

  connectedCallback(): void {
    const viewer = (this.#viewer = this.closest('fourdvt-viewer') as FourdvtViewer | null);
    const { signal } = (this.#listening = new AbortController());
    viewer?.addEventListener('canplay', () => { if (!this.#loading && !this.#actor?.player) void this.#load(); }, { signal });
    viewer?.addEventListener('playing', () => this.#actor?.play(), { signal });
    viewer?.addEventListener('pause', () => this.#actor?.pause(), { signal });
    this.#wishes.sequence = this.getAttribute('sequence');
    this.#wishes.travel = this.hasAttribute('travel');
    this.#wishes.placement = this.#placeOfAttributes();
    void this.#load();
  }
  disconnectedCallback(): void {
    this.#listening?.abort();
    ++this.#coming;
    if (this.#actor) this.#viewer?.removeActor(this.#actor);
    this.#actor = this.#viewer = null;
  }
  attributeChangedCallback(name: string, before: string | null, value: string | null): void {
    if (before === value || !this.#viewer) return;
    if (name === 'src') void this.#load();
    else if (name === 'sequence' && value) this.goTo(value);
    else if (name === 'travel') {
      this.#wishes.travel = value !== null;
      this.#actor?.setTravel(value !== null);
    } else this.placement = this.#placeOfAttributes();
  }

  goTo(state: string): void {
    this.#wishes.sequence = state;
    this.#actor?.goTo(state);
  }
  setParameter(name: string, value: number, immediate = false): void {
    this.#wishes.parameters.set(name, value);
    this.#actor?.setParameter(name, value, immediate);
  }
  get placement(): Placement {
    const state = this.#actor?.state();
    return state ? { x: state.x, z: state.z, heading: state.heading } : this.#wishes.placement;
  }
  set placement(place: Partial<Placement>) {
    this.#wishes.placement = { ...this.placement, ...place };
    this.#actor?.place(this.#wishes.placement);
  }
  get heading(): number { return this.placement.heading; }
  set heading(degrees: number) {
    if (this.#actor) this.#actor.steer(degrees);
    else this.#wishes.placement = { ...this.#wishes.placement, heading: degrees };
  }
  /** The character is loaded and stands in the canvas. */
  get present(): boolean { return this.#actor?.state()?.hasFrame ?? false; }

  async #load(): Promise<void> {
    const mine = ++this.#coming;
    const viewer = this.#viewer;
    this.#wishes.placement = this.placement;
    if (this.#actor) viewer?.removeActor(this.#actor);
    this.#actor = null;
    const src = this.getAttribute('src') ?? viewer?.src;
    if (!viewer || !src) return;
    this.#wishes.src = new URL(src, this.baseURI).href;
    this.#wishes.playing = !viewer.paused;
    this.#wishes.align = viewer.align === 'none' ? 'none' : 'baked';
    this.#loading = true;
    const actor = await viewer.addActor(this.#wishes, (name, detail) => this.dispatchEvent(new CustomEvent(name, { detail })));
    if (mine === this.#coming) this.#loading = false;
    if (!actor) return;
    if (mine === this.#coming) this.#actor = actor;
    else viewer.removeActor(actor);
  }

  /** position="x z" in metres, heading in degrees. */
  #placeOfAttributes(): Placement {
    const [x, z] = (this.getAttribute('position') ?? '').trim().split(/\s+/).map(Number);
    const heading = Number(this.getAttribute('heading'));
    const finite = (value: number | undefined): number => (value !== undefined && Number.isFinite(value) ? value : 0);
    return { x: finite(x), z: finite(z), heading: finite(heading) };
  }
}
