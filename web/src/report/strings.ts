// SPDX-License-Identifier: Apache-2.0
// Texts of <fourdvt-viewer>, by language; the player's second part adds its own (strings-more.ts). Pages may add languages
// and change texts in FourdvtViewer.strings. Names in braces are placeholders.

export interface Strings {
  /** Accessible name of a character without the attribute `alt`. */
  label: string;
  loading: string;
  play: string;
  retry: string;
  network: string;
  /** Note that the player's second part cannot be loaded: the character plays without it. */
  incomplete: string;
  /** Precedes one of the names below, of the step that a picture has waited for too long. */
  waiting: string;
  'on-manifest': string;
  'on-player': string;
  'on-more': string;
  'on-files': string;
  'on-decoder': string;
  'on-upload': string;
  'on-barcode': string;
  'on-geometry': string;
  'on-display': string;
  /** Texts of the panel for visitors, by the error's id; the event and the console have the details. */
  failure: string;
  'insecure-context': string;
  'decoder-unsupported': string;
  'decoder-lost': string;
  'files-differ': string;
  'out-of-memory': string;
}

/** Texts by language, then by name. */
export type Languages = Record<string, Record<string, string>>;

export const STRINGS: Languages = {
  en: {
    label: '4D character',
    loading: 'Loading',
    play: 'Play',
    retry: 'Try again',
    network: 'Waiting for the network …',
    incomplete: 'Part of the player cannot be loaded.',
    waiting: 'Waiting for',
    'on-manifest': 'the character',
    'on-player': 'the player',
    'on-more': 'the rest of the player',
    'on-files': "the character's files",
    'on-decoder': 'the video decoder',
    'on-upload': 'a copy of the picture',
    'on-barcode': 'the graphics processor',
    'on-geometry': 'the geometry',
    'on-display': 'the display',
    failure: 'This character cannot be shown.',
    'insecure-context': 'This page must come over https to show the character.',
    'decoder-unsupported': 'This browser cannot decode this character.',
    'decoder-lost': 'The browser stopped the video decoder.',
    'files-differ': 'The files of this character do not belong together.',
    'out-of-memory': 'The browser has no memory left for this character.',
  } satisfies Strings,
};

// Returns the nearest `lang` at or above the element, across shadow trees; else the browser's language.
function languageOf(element: Element): string {
  const found = element.closest('[lang]')?.getAttribute('lang');
  if (found) return found;
  const root = element.getRootNode();
  return root instanceof ShadowRoot ? languageOf(root.host) : navigator.language;
}

/** Returns all texts in the element's language, in English where a text is missing. */
export function stringsOf(element: Element, languages: Languages): Record<string, string> {
  const [language = ''] = languageOf(element).toLowerCase().split('-');
  return { ...languages['en'], ...languages[language] };
}
