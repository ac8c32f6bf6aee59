// SPDX-License-Identifier: Apache-2.0
// Feature: the orbit camera, its input by visitor and attributes, and how it follows the character.
import { parseOrbit, parseTarget } from '../camera/orbit-camera.js';
import { OrbitControls } from '../camera/orbit-controls.js';
import type { Playback } from './playback.js';
import { valueOf } from './properties.js';
import type { Feature, Viewer } from './viewer.js';

const ATTRIBUTES = /^(m\w+-)?camera-(orbit|target|follow)$|^field-of-view$/;
const MIN_FIELD_DEG = 5, MAX_FIELD_DEG = 120, DEFAULT_FIELD_DEG = 35;

export class View implements Feature {
  readonly #viewer: Viewer;
  readonly #playback: Playback;
  #controls: OrbitControls | null = null;
  #sinceInteraction = Infinity;

  constructor(viewer: Viewer, playback: Playback) {
    this.#viewer = viewer;
    this.#playback = playback;
  }

  connect(): void {
    const viewer = this.#viewer, { element, overlay, camera, picture } = viewer, playback = this.#playback;
    this.#controls = new OrbitControls(overlay.stage, camera, picture, {
      orbits: () => valueOf(element, 'camera-controls'),
      wheelZooms: () => valueOf(element, 'zoom'),
      sensitivity: () => ({ orbit: valueOf(element, 'orbit-sensitivity'), zoom: valueOf(element, 'disable-zoom') ? 0 : valueOf(element, 'zoom-sensitivity') }),
      onInteract: () => {
        this.#sinceInteraction = 0;
        viewer.touch();
        viewer.session?.wake();
        viewer.emit('camera-change');
      },
      togglePlay: () => (playback.paused ? void playback.play() : playback.pause()),
    });
  }
  disconnect(): void {
    this.#controls?.dispose();
    this.#controls = null;
  }
  reset(): void { this.#apply(); }
  update(name: string, changed: boolean): void { if (changed && ATTRIBUTES.test(name)) this.#apply(); }
  resize(width: number, height: number): void {
    const { camera } = this.#viewer;
    if (height > 0) camera.setAspect(width / height);
    if (this.#sinceInteraction === Infinity) camera.jump();
  }
  frame(stepS: number): boolean {
    const { element, camera, reducedMotion } = this.#viewer;
    this.#sinceInteraction += stepS;
    const rotates = valueOf(element, 'auto-rotate') && !this.#playback.stopped && !reducedMotion.matches && !this.#controls?.dragging &&
      1000 * this.#sinceInteraction > valueOf(element, 'auto-rotate-delay');
    const { azimuth } = camera.goal;
    if (rotates) camera.rotate(valueOf(element, 'rotation-per-second') * stepS, 0);
    const turned = camera.goal.azimuth !== azimuth; // false at a limit
    if (reducedMotion.matches) camera.jump();
    return camera.update(stepS) || turned;
  }

  #apply(): void {
    const { element, camera, character, reducedMotion } = this.#viewer, field = valueOf(element, 'field-of-view');
    camera.fov = field >= MIN_FIELD_DEG && field <= MAX_FIELD_DEG ? field : DEFAULT_FIELD_DEG;
    camera.setLimits(element.getAttribute('min-camera-orbit'), element.getAttribute('max-camera-orbit'));
    camera.setTarget(parseTarget(element.getAttribute('camera-target')));
    camera.setFollow(valueOf(element, 'camera-follow'));
    if (character) camera.setCharacter(character);
    camera.setHome(parseOrbit(element.getAttribute('camera-orbit')));
    if (!character || reducedMotion.matches) camera.jump();
  }
}
