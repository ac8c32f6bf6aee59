// SPDX-License-Identifier: Apache-2.0
// Feature: the player's second part's buttons, announcements for screen readers, prompt, hotspots and sound.
import type { More } from '../player/wasm-module.js';
import type { Feature, Viewer } from './viewer.js';

type Extras = InstanceType<More['Extras']>;
type Extended = ConstructorParameters<More['Extras']>[0];

export class SecondPart implements Feature {
  readonly #viewer: Viewer;
  readonly #element: Extended;
  /** Null until the second part is loaded. */
  extras: Extras | null = null;

  constructor(viewer: Viewer, element: Extended) {
    this.#viewer = viewer;
    this.#element = element;
  }

  more(more: More): void {
    const viewer = this.#viewer, { connected, overlay, statics } = viewer;
    if (!connected || this.extras) return;
    this.extras = new more.Extras(this.#element, overlay.stage, statics.strings, {
      player: () => viewer.session?.wholePlayer ?? null,
      wake: () => viewer.session?.wake(),
      layered: () => (viewer.character ? !viewer.character.fromCameras : null),
      pose: () => viewer.camera.pose,
      goal: () => viewer.camera.destination,
      picture: viewer.picture,
      source: () => viewer,
    });
    viewer.updateTexts();
  }
  frame(): void { this.extras?.turn(); }
  update(): void { this.extras?.update(); }
  updateTexts(): void { this.extras?.update(); }
  disconnect(): void {
    this.extras?.dispose();
    this.extras = null;
  }
}
