// SPDX-License-Identifier: Apache-2.0
// Feature: render options, drawing method, look, room, scene and quality of the characters.
import { qualityOf } from '../page/quality-attribute.js';
import { checkRenderOptions } from '../player/input-checks.js';
import { methodOf } from '../player/method-attributes.js';
import type { RenderOptions, SceneMesh, Settings } from '../player/wasm-player.js';
import { valueOf } from './properties.js';
import type { Feature, Viewer } from './viewer.js';

const DEFAULT_RENDER: RenderOptions = {
  background: [0, 0, 0, 0], groundShadow: true, shadowStrength: 0.45, samples: 4, debug: 'none', debugLayer: 0,
};
const METHOD = ['method', 'cameras', 'visibility'], LOOK = ['look', 'look-strength', 'light', 'light-turn'];

export class Appearance implements Feature {
  readonly #viewer: Viewer;

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
    viewer.commands.set('options', DEFAULT_RENDER);
  }

  setScene(meshes: SceneMesh[]): void {
    const scene = meshes.map((mesh) => ({ ...mesh, corners: Float32Array.from(mesh.corners) }));
    const whole = scene.every(({ corners }) => corners.length % 18 === 0 && corners.every(Number.isFinite));
    if (!whole) throw new RangeError('a scene mesh needs 18 finite numbers per triangle');
    this.#viewer.commands.set('scene', scene.filter(({ corners }) => corners.length > 0));
  }
  get options(): RenderOptions { return { ...this.#viewer.commands.settings.options! }; }
  setOptions(options: Partial<RenderOptions>): void {
    const all = { ...this.options, ...options };
    checkRenderOptions(all, this.#viewer.session?.layers);
    this.#viewer.commands.set('options', all);
  }

  settings(): Partial<Settings> { return { method: methodOf(this.#viewer.element) }; }
  update(name: string, changed: boolean): void {
    const { element, commands, session } = this.#viewer;
    if (!changed) return;
    if (name === 'quality') this.resize();
    if (name === 'background') session?.later.setRoom(valueOf(element, 'background') === 'room');
    if (METHOD.includes(name)) commands.set('method', methodOf(element));
    if (METHOD.includes(name) || LOOK.includes(name)) session?.later.useLook();
  }
  resize(): void {
    const { element, commands, size } = this.#viewer;
    const quality = qualityOf(element, size.height), { quality: before } = commands.settings;
    if (before?.rendition !== quality.rendition || before.maxTexels !== quality.maxTexels) commands.set('quality', quality);
  }
}
