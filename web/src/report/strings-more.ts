// SPDX-License-Identifier: Apache-2.0
// Texts of the player's second part, and all texts in German. Part of fourdvt-more.js.
import type { Languages, Strings } from './strings.js';

interface MoreStrings {
  pause: string;
  time: string;
  /** {now} and {end} are minutes and seconds. */
  timeOf: string;
  mute: string;
  unmute: string;
  fullscreen: string;
  leaveFullscreen: string;
  controls: string;
  prompt: string;
  playing: string;
  paused: string;
  ended: string;
  /** {side}: one of the eight below; {height}: above, below or nothing. */
  view: string;
  front: string;
  frontRight: string;
  right: string;
  backRight: string;
  back: string;
  backLeft: string;
  left: string;
  frontLeft: string;
  above: string;
  below: string;
}

const EN: MoreStrings = {
  pause: 'Pause', time: 'Time', timeOf: '{now} of {end}', mute: 'Mute', unmute: 'Unmute', fullscreen: 'Full screen',
  leaveFullscreen: 'Leave full screen', controls: 'Controls', prompt: 'Drag, or use the arrow keys, to turn the view',
  playing: 'Playing {motion}', paused: 'Paused', ended: 'At the end of {motion}', view: 'Seen from {side}{height}',
  front: 'the front', frontRight: 'the front, on the right', right: 'the right', backRight: 'behind, on the right', back: 'behind', backLeft: 'behind, on the left',
  left: 'the left', frontLeft: 'the front, on the left', above: ', from above', below: ', from below',
};

const DE: MoreStrings & Strings = {
  label: '4D-Figur', loading: 'Wird geladen', play: 'Abspielen', retry: 'Noch einmal versuchen', network: 'Warten auf das Netz …',
  incomplete: 'Ein Teil des Players kann nicht geladen werden.',
  waiting: 'Warten auf', 'on-manifest': 'die Figur', 'on-player': 'den Player', 'on-more': 'den Rest des Players', 'on-files': 'die Dateien der Figur', 'on-decoder': 'den Videodecoder',
  'on-upload': 'eine Kopie des Bildes', 'on-barcode': 'den Grafikprozessor', 'on-geometry': 'die Geometrie', 'on-display': 'die Anzeige',
  failure: 'Diese Figur kann nicht gezeigt werden.', 'insecure-context': 'Die Figur wird nur auf Seiten gezeigt, die über https kommen.',
  'decoder-unsupported': 'Dieser Browser kann diese Figur nicht dekodieren.', 'decoder-lost': 'Der Browser hat den Videodecoder weggenommen.',
  'files-differ': 'Die Dateien dieser Figur gehören nicht zusammen.', 'out-of-memory': 'Der Browser hat keinen Speicher mehr für diese Figur.',
  pause: 'Anhalten', time: 'Zeit', timeOf: '{now} von {end}', mute: 'Ton aus', unmute: 'Ton an', fullscreen: 'Vollbild',
  leaveFullscreen: 'Vollbild beenden', controls: 'Bedienung', prompt: 'Zum Drehen ziehen oder die Pfeiltasten drücken',
  playing: '{motion} läuft', paused: 'Angehalten', ended: '{motion} ist zu Ende', view: 'Gesehen von {side}{height}',
  front: 'vorn', frontRight: 'vorn rechts', right: 'rechts', backRight: 'hinten rechts', back: 'hinten', backLeft: 'hinten links',
  left: 'links', frontLeft: 'vorn links', above: ', von oben', below: ', von unten',
};

/** Adds the texts to `languages`; texts set by a page stay. */
export function addStrings(languages: Languages): void {
  for (const [name, texts] of Object.entries({ en: EN, de: DE })) languages[name] = { ...texts, ...languages[name] };
}

/** Replaces each name in braces by its value. */
export const fill = (text: string, values: Record<string, string>): string => text.replace(/\{(\w+)\}/g, (_, name: string) => values[name] ?? '');
