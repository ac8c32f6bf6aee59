// SPDX-License-Identifier: Apache-2.0
// Feature of <fourdvt-viewer>: the orbit camera, what moves it, and what it follows.
import { isOn } from '../page/attributes.js';
import { parseOrbit, parseTarget, type Follow } from '../camera/orbit-camera.js';
import { OrbitControls } from '../camera/orbit-controls.js';
import { animate, emit, onArrival, onAttribute, onLeft, onResize, parts, touched, type Constructor, type ViewerBase } from './base.js';
import { stopped, type Playback } from './playback.js';

const AUTO_ROTATE_DEG_S = 14;
const AUTO_ROTATE_DELAY_MS = 4000;
const VIEW = ['camera-orbit', 'min-camera-orbit', 'max-camera-orbit', 'camera-target', 'camera-follow', 'field-of-view'];

export interface Orbit {
  azimuth: number;
  elevation: number;
  distance: number;
}

export interface Camera {
  getCameraOrbit(): Orbit;
  /** Ends the camera's glide towards its goal. */
  jumpCameraToGoal(): void;
}

export function withCamera<T extends Constructor<ViewerBase & Playback>>(Base: T): T & Constructor<Camera> {
  return class extends Base implements Camera {
    static override get observedAttributes(): readonly string[] { return [...super.observedAttributes, ...VIEW, 'auto-rotate']; }

    #controls: OrbitControls | null = null;
    #sinceInteraction = Infinity;

    getCameraOrbit(): Orbit {
      const { azimuth, elevation, distance } = this[parts].camera.pose;
      return { azimuth, elevation, distance };
    }
    jumpCameraToGoal(): void {
      this[parts].camera.jump();
      this[parts].session?.wake();
    }

    override connectedCallback(): void {
      super.connectedCallback();
      const { overlay, camera, picture } = this[parts];
      this.#controls ??= new OrbitControls(overlay.stage, camera, picture, {
        orbits: () => isOn(this, 'camera-controls'),
        wheelZooms: () => isOn(this, 'zoom'),
        sensitivity: () => ({ orbit: this.#number('orbit-sensitivity', 1), zoom: isOn(this, 'disable-zoom') ? 0 : this.#number('zoom-sensitivity', 1) }),
        onInteract: () => {
          this.#sinceInteraction = 0;
          this[touched]();
          this[parts].session?.wake();
          this[emit]('camera-change');
        },
        togglePlay: () => (this.paused ? void this.play() : this.pause()),
      });
    }
    override [onArrival](): void {
      this.#apply();
      super[onArrival]();
    }
    override [onLeft](): void {
      super[onLeft]();
      this.#controls?.dispose();
      this.#controls = null;
    }
    override [onAttribute](name: string, before: string | null, value: string | null): void {
      super[onAttribute](name, before, value);
      if (before !== value && VIEW.includes(name) && this[parts].connected) this.#apply();
    }
    override [onResize](width: number, height: number): void {
      super[onResize](width, height);
      const { camera } = this[parts];
      if (height > 0) camera.setAspect(width / height);
      if (this.#sinceInteraction === Infinity) camera.jump();
    }

    // Number that an attribute begins with.
    #number(name: string, fallback: number): number {
      const value = parseFloat(this.getAttribute(name) ?? '');
      return Number.isFinite(value) ? value : fallback;
    }
    #apply(): void {
      const { camera, session, reducedMotion } = this[parts];
      const fov = parseFloat(this.getAttribute('field-of-view') ?? '');
      camera.fov = fov >= 5 && fov <= 120 ? fov : 35;
      camera.setLimits(this.getAttribute('min-camera-orbit'), this.getAttribute('max-camera-orbit'));
      camera.setTarget(parseTarget(this.getAttribute('camera-target')));
      const follow = this.getAttribute('camera-follow');
      camera.setFollow((['position', 'behind'] as (string | null)[]).includes(follow) ? follow as Follow : 'none');
      if (session?.character) camera.setCharacter(session.character);
      camera.setHome(parseOrbit(this.getAttribute('camera-orbit')));
      if (!session?.character || reducedMotion.matches) camera.jump();
    }

    override [animate](dtS: number): boolean {
      const { camera, reducedMotion } = this[parts];
      this.#sinceInteraction += dtS;
      const rotating = isOn(this, 'auto-rotate') && !this[stopped] && !reducedMotion.matches && !this.#controls?.dragging &&
        1000 * this.#sinceInteraction > this.#number('auto-rotate-delay', AUTO_ROTATE_DELAY_MS);
      const { azimuth } = camera.goal;
      if (rotating) camera.rotate(this.#number('rotation-per-second', AUTO_ROTATE_DEG_S) * dtS, 0);
      const turned = camera.goal.azimuth !== azimuth; // up to its limits
      if (reducedMotion.matches) camera.jump();
      const moves = super[animate](dtS);
      return camera.update(dtS) || turned || moves;
    }
  };
}
