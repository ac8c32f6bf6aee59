// SPDX-License-Identifier: Apache-2.0
// Attributes of <fourdvt-viewer>, one row each: observed names, reflecting properties and their types derive from this
// table. tests/tree/element.test.mjs compares it with the table in web/README.md.
import { isOn } from '../page/attributes.js';
import { ALIGN_MODES } from '../player/wasm-player.js';

/** Row of an attribute; its value is a text unless a field below changes that. */
interface Attribute {
  /** Boolean: on if present and not "false". */
  readonly flag?: true;
  /** Allowed texts; any other counts as the default. */
  readonly of?: readonly string[];
  /** Value without the attribute; '' if left out. If a number, values are the number at the text's start. */
  readonly default?: string | number | null;
  /** Name of the reflecting property. */
  readonly property?: string;
  /** Read at each use: not observed. */
  readonly onUse?: true;
}

export const ATTRIBUTES = {
  src: { property: 'src' },
  loading: { of: ['auto', 'lazy', 'eager'], default: 'auto', property: 'loading' },
  preload: { default: 'auto', property: 'preload' },
  crossorigin: { default: null, property: 'crossOrigin', onUse: true },
  poster: { property: 'poster' },
  reveal: { onUse: true },
  alt: {},
  lang: {},
  'upload-path': { default: 'auto', onUse: true },

  autoplay: { flag: true, property: 'autoplay', onUse: true },
  loop: { flag: true },
  muted: { flag: true, property: 'defaultMuted', onUse: true },

  sequence: {},
  travel: { flag: true, property: 'travel' },
  align: { of: ALIGN_MODES, default: 'baked', property: 'align' },
  'motion-controls': { flag: true },
  action: { onUse: true },

  'camera-controls': { flag: true },
  'camera-orbit': {},
  'min-camera-orbit': {},
  'max-camera-orbit': {},
  'camera-target': {},
  'camera-follow': { of: ['none', 'position', 'behind'], default: 'none' },
  'field-of-view': { default: 35 },
  'orbit-sensitivity': { default: 1, onUse: true },
  'zoom-sensitivity': { default: 1, onUse: true },
  zoom: { flag: true, onUse: true },
  'disable-zoom': { flag: true, onUse: true },
  'touch-action': {},
  'auto-rotate': { flag: true },
  'auto-rotate-delay': { default: 4000, onUse: true },
  'rotation-per-second': { default: 14, onUse: true },
  'interaction-prompt': {},

  controls: { flag: true },
  quality: { default: 'auto', property: 'quality' },
  method: {},
  cameras: {},
  visibility: {},
  look: {},
  'look-strength': {},
  light: {},
  'light-turn': {},
  background: {},
} as const satisfies Record<string, Attribute>;

type Rows = typeof ATTRIBUTES;
export type AttributeName = keyof Rows;
type Value<Row> = Row extends { of: readonly (infer Text)[] } ? Text : Row extends { flag: true } ? boolean
  : Row extends { default: number } ? number : Row extends { default: null } ? string | null : string;
/** Properties that reflect attributes. */
export type Reflected = { [Name in AttributeName as Rows[Name] extends { property: infer Property extends string } ? Property : never]: Value<Rows[Name]> };

const rows: [AttributeName, Attribute][] = Object.entries(ATTRIBUTES) as [AttributeName, Attribute][];

export const OBSERVED: readonly string[] = rows.filter(([, { onUse }]) => !onUse).map(([name]) => name);

/** Value of an attribute. */
export function valueOf<Name extends AttributeName>(element: Element, name: Name): Value<Rows[Name]> {
  const { flag, of, default: fallback = '' }: Attribute = ATTRIBUTES[name], text = element.getAttribute(name);
  let value: unknown = fallback === null ? text : text || fallback;
  if (flag) value = isOn(element, name);
  if (of?.includes(text!) === false) value = fallback;
  if (typeof fallback === 'number') value = Number.isFinite(parseFloat(text!)) ? parseFloat(text!) : fallback;
  return value as Value<Rows[Name]>;
}

/** Defines the reflecting properties of an element's class. */
export function reflect(prototype: HTMLElement): void {
  for (const [name, { flag, property, default: fallback }] of rows) {
    if (!property) continue;
    Object.defineProperty(prototype, property, {
      configurable: true,
      get(this: HTMLElement) { return valueOf(this, name); },
      set(this: HTMLElement, value: unknown) {
        if (flag) this.toggleAttribute(name, value as boolean);
        else if (value === null && fallback === null) this.removeAttribute(name);
        else this.setAttribute(name, value as string);
      },
    });
  }
}
