// SPDX-License-Identifier: Apache-2.0
// Feature of <fourdvt-viewer>: how the characters look, what they stand in, at which quality, and pictures of it.
import type { Wishes } from '../player/commands.js';
import { checkRenderOptions } from '../player/input-checks.js';
import { methodOf } from '../player/method-attributes.js';
import { qualityOf } from '../page/quality-attribute.js';
import type { SessionOptions, Snapshot } from '../session/session-host.js';
import { statsOf, type ViewerStats } from './stats.js';
import type { RenderOptions, SceneMesh } from '../player/wasm-player.js';
import { firstWishes, onAttribute, onResize, parts, sessionOptions, type Constructor, type ViewerBase } from './base.js';

const DEFAULT_RENDER: RenderOptions = {
  background: [0, 0, 0, 0], groundShadow: true, shadowStrength: 0.45, samples: 4, debug: 'none', debugLayer: 0,
};
const METHOD = ['method', 'cameras', 'visibility'], LOOK = ['look', 'look-strength', 'light', 'light-turn'];

export interface Look {
  /** 'auto', 'highest', or a rendition's number, 0 for the lowest. */
  quality: string;
  /** How a character from cameras is drawn, once it is loaded; web/README.md lists the methods. */
  method: string;
  /** Meshes that the characters stand among; web/README.md says what they consist of. */
  scene: SceneMesh[];
  /** Background, ground shadow, multisampling, debug views. Assigning some of the options keeps the others. */
  get renderOptions(): RenderOptions;
  set renderOptions(options: Partial<RenderOptions>);
  readonly stats: ViewerStats | null;
  /** A PNG of the shown frame, at the size and pose of the snapshot if there is one. Null before the first picture. */
  toBlob(snapshot?: Snapshot): Promise<Blob | null>;
  /** The same as a data: address; empty before the first picture. */
  toDataURL(snapshot?: Snapshot): Promise<string>;
  /** Size of the box that all of the character's motions fill, metres; null before it is loaded. */
  getDimensions(): { x: number; y: number; z: number } | null;
}

export function withAppearance<T extends Constructor<ViewerBase>>(Base: T): T & Constructor<Look> {
  return class extends Base implements Look {
    static override get observedAttributes(): readonly string[] {
      return [...super.observedAttributes, ...METHOD, ...LOOK, 'background', 'quality'];
    }

    constructor(...args: any[]) {
      super(...args);
      this[parts].commands.set('options', DEFAULT_RENDER);
    }

    get quality(): string { return this.getAttribute('quality') || 'auto'; }
    set quality(value: string) { this.setAttribute('quality', value); }
    get method(): string { return methodOf(this).name || this[parts].session?.character?.method || ''; }
    set method(name: string) { this.setAttribute('method', name); }
    get scene(): SceneMesh[] { return this[parts].commands.wishes.scene ?? []; }
    set scene(meshes: SceneMesh[]) {
      const scene = meshes.map((mesh) => ({ ...mesh, corners: Float32Array.from(mesh.corners) }));
      const whole = scene.every(({ corners }) => corners.length % 18 === 0 && corners.every(Number.isFinite));
      if (!whole) throw new RangeError('a scene mesh needs 18 finite numbers per triangle');
      this[parts].commands.set('scene', scene.filter(({ corners }) => corners.length > 0));
    }
    get renderOptions(): RenderOptions { return { ...this[parts].commands.wishes.options! }; }
    set renderOptions(options: Partial<RenderOptions>) {
      const all = { ...this.renderOptions, ...options };
      checkRenderOptions(all, this[parts].session?.layers);
      this[parts].commands.set('options', all);
    }
    get stats(): ViewerStats | null {
      const state = this[parts].commands.state();
      return state && statsOf(state, this[parts].session!.path);
    }
    toBlob(snapshot?: Snapshot): Promise<Blob | null> {
      return this[parts].session?.drawing.toBlob(snapshot) ?? Promise.resolve(null);
    }

    async toDataURL(snapshot?: Snapshot): Promise<string> {
      const blob = await this.toBlob(snapshot);
      return blob ? new Promise((done) => {
        const reader = new FileReader();
        reader.onload = () => done(reader.result as string);
        reader.readAsDataURL(blob);
      }) : '';
    }
    getDimensions(): { x: number; y: number; z: number } | null {
      const { min, max } = this[parts].session?.character ?? {};
      return min && max ? { x: max[0] - min[0], y: max[1] - min[1], z: max[2] - min[2] } : null;
    }

    override [firstWishes](): Partial<Wishes> { return { ...super[firstWishes](), method: methodOf(this) }; }
    override [sessionOptions](): Partial<SessionOptions> { return { ...super[sessionOptions](), room: this.#room }; }
    override [onAttribute](name: string, before: string | null, value: string | null): void {
      super[onAttribute](name, before, value);
      const { connected, commands, session } = this[parts];
      if (!connected || before === value) return;
      if (name === 'quality') this.#applyQuality();
      if (name === 'background') session?.later.setRoom(this.#room);
      if (METHOD.includes(name)) commands.set('method', methodOf(this));
      if (METHOD.includes(name) || LOOK.includes(name)) session?.later.useLook();
    }
    override [onResize](width: number, height: number): void {
      super[onResize](width, height);
      this.#applyQuality();
    }

    get #room(): boolean { return this.getAttribute('background') === 'room'; }

    #applyQuality(): void {
      const { commands, size } = this[parts];
      const wish = qualityOf(this, size.height), { quality: before } = commands.wishes;
      if (before?.rendition !== wish.rendition || before.mostTexels !== wish.mostTexels) commands.set('quality', wish);
    }
  };
}
