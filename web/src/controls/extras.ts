// SPDX-License-Identifier: Apache-2.0
// Parts of one viewer that come with fourdvt-more.js: buttons, announcements, hotspots, sound, and the prompt to turn
// the view.
import { isOn } from '../page/attributes.js';
import { adopt } from '../page/documents.js';
import { addStrings } from '../report/strings-more.js';
import { stringsOf, type Languages } from '../report/strings.js';
import { Sound, type Audible, type SoundSource } from '../sound/sound.js';
import { Announcer, type Announced, type ViewGoal } from './announcer.js';
import { Chapters } from './chapters.js';
import { Controls, type Controlled } from './controls.js';
import { Hotspots, type HotspotScene } from './hotspots.js';

const PROMPT_MS = 3000; // without an input before the prompt is shown
const CSS = `
.prompt { position: absolute; left: 0; right: 0; bottom: 72px; width: fit-content; max-width: 90%; margin: 0 auto; padding: 6px 14px; border-radius: 16px;
  font: 14px/1.4 system-ui, sans-serif; color: #fff; background: rgba(20,20,24,.75); pointer-events: none; transition: opacity .4s; }
@media (forced-colors: active) { .prompt { border: 1px solid; } }
.hotspot { position: absolute; left: 0; top: 0; }
.live { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap; margin: 0; }
`;

export class Extras {
  readonly #hotspots: Hotspots;
  readonly #viewer: Controlled & Announced & Audible;
  readonly #languages: Languages;
  readonly #prompt: HTMLSlotElement;
  readonly #controls: Controls;
  readonly #announcer: Announcer;
  readonly #sound: Sound;
  readonly #chapters: Chapters;
  readonly #abort = new AbortController();
  #timer: ReturnType<typeof setTimeout> | undefined; // until the prompt
  #prompts = true; // the visitor has not turned the view yet

  /** stage: element of the viewer's shadow tree. Adds the second part's texts to `languages`. */
  constructor(viewer: Controlled & Announced & Audible, stage: HTMLElement, languages: Languages, scene: HotspotScene & { source(): SoundSource; readonly goal: ViewGoal }) {
    const root = stage.getRootNode() as ShadowRoot, content = stage.parentElement!;
    addStrings(languages);
    this.#viewer = viewer;
    this.#languages = languages;
    adopt(root, CSS);
    this.#prompt = document.createElement('slot');
    this.#prompt.name = this.#prompt.className = 'prompt';
    this.#prompt.setAttribute('part', 'prompt');
    this.#prompt.hidden = true;
    content.append(this.#prompt);
    this.#hotspots = new Hotspots(viewer, content, scene);
    this.#sound = new Sound(viewer, () => scene.source(), () => this.#controls?.show());
    this.#chapters = new Chapters(viewer, root, () => this.#controls?.show());
    this.#controls = new Controls(viewer, content, this.#sound, (motion) => this.#chapters.of(motion));
    this.#announcer = new Announcer(viewer, root, scene.goal);
    viewer.addEventListener('camera-change', () => this.#endPrompt(), { signal: this.#abort.signal });
    this.update();
  }

  /** Called when texts or attributes have changed. */
  update(): void {
    const strings = stringsOf(this.#viewer, this.#languages);
    this.#prompt.textContent = strings['prompt']!;
    this.#controls.update(strings);
    this.#announcer.update(strings);
    if (!this.#prompts) return;
    const invites = isOn(this.#viewer, 'camera-controls') && isOn(this.#viewer, 'interaction-prompt') && !this.#viewer.matches('[interaction-prompt=none]');
    if (!invites) {
      clearTimeout(this.#timer);
      this.#timer = undefined;
      this.#prompt.hidden = true;
    } else {
      this.#timer ??= setTimeout(() => { this.#prompt.hidden = false; }, PROMPT_MS);
    }
  }
  #endPrompt(): void {
    this.#prompts = false;
    clearTimeout(this.#timer);
    this.#prompt.hidden = true;
  }
  turn(): void {
    this.#sound.turn();
    this.#controls.turn();
    this.#hotspots.turn();
  }
  get hasSound(): boolean { return this.#sound.present; }
  vertexAt(x: number, y: number): number | null { return this.#hotspots.vertexAt(x, y); }
  dispose(): void {
    this.#abort.abort();
    clearTimeout(this.#timer);
    this.#hotspots.dispose();
    this.#controls.dispose();
    this.#announcer.dispose();
    this.#sound.dispose();
    this.#chapters.dispose();
    this.#prompt.remove();
  }
}
