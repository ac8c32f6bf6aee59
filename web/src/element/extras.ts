// SPDX-License-Identifier: Apache-2.0
// Feature of <fourdvt-viewer>: buttons and controls, announcements for screen readers, the prompt, hotspots and sound, which come with extras.ts
// of the player's second part.
import type { More } from '../player/wasm-module.js';
import { animate, applyTexts, onAttribute, onLeft, onMore, parts, type Constructor, type ViewerBase } from './base.js';
import type { Camera } from './camera.js';
import type { Media } from './media.js';
import type { Motion } from './motion.js';
import type { Playback } from './playback.js';

export interface Extras {
  /** Of its <track> elements; undefined until the player's second part is there. */
  readonly textTracks?: TextTrackList;
  /** The motion that is shown has sound. False until the player's second part is there. */
  readonly hasSound: boolean;
  /** Shows what is behind the poster; with reveal="manual" nothing else does. */
  dismissPoster(): void;
  /** The vertex for a hotspot's `data-vertex` at a point of the page, CSS pixels; null where no surface of a layered character is. */
  vertexFromPoint(clientX: number, clientY: number): number | null;
}

export function withExtras<T extends Constructor<ViewerBase & Camera & Media & Motion & Playback>>(Base: T): T & Constructor<Extras> {
  return class extends Base implements Extras {
    static override get observedAttributes(): readonly string[] { return [...super.observedAttributes, 'controls', 'interaction-prompt']; }

    #extras: InstanceType<More['Extras']> | null = null;

    get hasSound(): boolean { return this.#extras?.hasSound ?? false; }
    dismissPoster(): void { this[parts].overlay.dismissPoster(); }

    vertexFromPoint(clientX: number, clientY: number): number | null { return this.#extras?.vertexAt(clientX, clientY) ?? null; }

    override [onMore](more: More): void {
      super[onMore](more);
      if (!this[parts].connected || this.#extras) return;
      const languages = (this.constructor as unknown as { strings: Record<string, Record<string, string>> }).strings;
      this.#extras = new more.Extras(this, this[parts].overlay.stage, languages, {
        player: () => this[parts].session?.wholePlayer ?? null,
        wake: () => this[parts].session?.wake(),
        layered: () => {
          const { character } = this[parts].session ?? {};
          return character ? !character.fromCameras : null;
        },
        pose: () => this[parts].camera.pose,
        picture: this[parts].picture,
        heard: () => this[parts],
      });
      this[applyTexts]();
    }
    override [animate](dtS: number): boolean {
      this.#extras?.turn();
      return super[animate](dtS);
    }
    override [applyTexts](): void {
      super[applyTexts]();
      this.#extras?.update();
    }
    override [onAttribute](name: string, before: string | null, value: string | null): void {
      super[onAttribute](name, before, value);
      this.#extras?.update();
    }
    override [onLeft](): void {
      super[onLeft]();
      this.#extras?.dispose();
      this.#extras = null;
    }
  };
}
