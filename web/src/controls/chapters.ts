// SPDX-License-Identifier: Apache-2.0
// Reads the chapters of a viewer's motions from its <track kind="chapters"> children (WebVTT), through a hidden <video>
// that never plays. Part of fourdvt-more.js.
export interface Chapter {
  startS: number;
  endS: number;
  title: string;
}

export class Chapters {
  readonly #viewer: HTMLElement;
  readonly #video = document.createElement('video');
  readonly #changed: () => void;
  readonly #children: MutationObserver;
  readonly #copies = new Map<HTMLTrackElement, HTMLTrackElement>(); // in the <video>, by the page's elements

  /** Puts the <video> into `root`, the viewer's shadow tree, and defines the viewer's property `textTracks`. */
  constructor(viewer: HTMLElement, root: ShadowRoot, changed: () => void) {
    this.#viewer = viewer;
    this.#changed = changed;
    this.#video.hidden = true;
    this.#video.style.display = 'none';
    this.#video.crossOrigin = viewer.getAttribute('crossorigin') ?? 'anonymous';
    root.append(this.#video);
    Object.defineProperty(viewer, 'textTracks', { configurable: true, value: this.#video.textTracks });
    this.#children = new MutationObserver((changes) => {
      for (const { type, target } of changes) if (type === 'attributes') this.#drop(target as HTMLTrackElement);
      this.#read();
    });
    this.#children.observe(viewer, { childList: true, subtree: true, attributeFilter: ['src', 'kind', 'label', 'srclang', 'data-sequence'] });
    this.#read();
  }

  /** Chapters of a motion, by start time. A track without `data-sequence` applies to every motion. */
  of(motion: string): Chapter[] {
    const found: Chapter[] = [];
    for (const [given, { track }] of this.#copies) {
      const { sequence = motion } = given.dataset;
      if (track.kind !== 'chapters' || sequence !== motion) continue;
      for (const cue of track.cues ?? []) found.push({ startS: cue.startTime, endS: cue.endTime, title: (cue as VTTCue).text });
    }
    return found.sort((a, b) => a.startS - b.startS);
  }
  dispose(): void {
    this.#children.disconnect();
    delete (this.#viewer as { textTracks?: unknown }).textTracks;
    this.#video.remove();
  }

  #drop(own: HTMLTrackElement): void {
    this.#copies.get(own)?.remove();
    this.#copies.delete(own);
  }
  #read(): void {
    const given = [...this.#viewer.querySelectorAll<HTMLTrackElement>(':scope > track')];
    for (const own of [...this.#copies.keys()]) if (!given.includes(own)) this.#drop(own);
    for (const own of given) {
      if (this.#copies.has(own)) continue;
      const copy = own.cloneNode() as HTMLTrackElement;
      copy.addEventListener('load', () => this.#changed());
      copy.addEventListener('error', () => console.warn(`fourdvt-viewer: ${copy.src}: the chapters cannot be loaded; check the address, and that it is WebVTT`));
      this.#copies.set(own, copy);
      this.#video.append(copy);
      if (copy.kind === 'chapters') copy.track.mode = 'hidden'; // loads the cues without showing them
    }
    this.#changed();
  }
}
