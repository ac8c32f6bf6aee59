// SPDX-License-Identifier: Apache-2.0
// Figures as text: values with their unit and rounding, seconds with their ratio to the yardstick, texts that hold {id}, goals.
// Depends on figures.json and the catalogue, not on HTML, Markdown or files.
import { figures as catalogue } from './catalogue.mjs';
import { inYardsticks, kSecondsOf } from './yardstick.mjs';

export const kNotMeasured = 'not measured in this run';
export const kStale = '†';  // beside a figure whose inputs have changed since it was measured
export const kStaleNote = `${kStale} stale: what it is measured from has changed since.`;

// Formats a number: "−0.07", "41,361"; a negative value that rounds to zero has no sign.
export function fixed(value, digits) {
  const number = Math.abs(value).toLocaleString('en', { minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: Math.abs(value) >= 1e4 });
  return value < 0 && /[1-9]/.test(number) ? `−${number}` : number;
}

function keyText(key) {
  if (/\.(js|wasm)$/.test(key)) return key;
  return key.replace(/^(\d+)x(\d+)$/, '$1×$2').replaceAll('-', ' ');
}

const kOfMotions = new Set(catalogue.filter(({ clock }) => clock === 'motion').map(({ id }) => id));

export class Shown {
  // parts: records of the parts, by name. stale: names of those whose inputs have changed.
  constructor({ figures, runs = {}, parts = {}, stale = [] }) {
    this.stale = new Set(stale);
    this.runs = runs;
    this.parts = parts;
    this.figures = figures;
    this.byId = new Map(figures.map((figure) => [figure.id, figure]));
    this.known = new Set(catalogue.map((figure) => figure.id));
  }

  // Returns the figures of an id: one, or one per key. Throws for an unknown id, an error of the text that contains it.
  group(id) {
    const one = this.byId.get(id);
    if (one) return [one];
    const group = this.figures.filter((figure) => figure.of === id);
    if (!group.length && !this.known.has(id) && !this.known.has(id.slice(0, id.lastIndexOf('.'))))
      throw new Error(`no figure is named ${id}; the names are in site/measured/catalogue.mjs`);
    return group;
  }

  // Returns a figure as text, such as "5.7 / 5.8 / 5.1 Mbit/s", with kStale where it is; null if it was not measured.
  text(id) {
    const group = this.group(id);
    if (!group.length) return null;
    return this.plain(group) + (this.isStale(group) ? kStale : '');
  }

  isStale(group) {
    return group.some(({ parts = [] }) => parts.some((part) => this.stale.has(part)));
  }

  plain(group) {
    const { unit, digits } = group[0];
    const values = group.map((figure) => figure.text ?? fixed(figure.value, digits) + (figure.se === undefined ? '' : ` ± ${fixed(figure.se, digits)}`));
    if (group.every((figure) => figure.text)) return values.join(' / ');
    if (group.some((figure) => figure.text)) return group.map((figure, i) => figure.text ?? `${values[i]}\u00a0${unit}`).join(' / ');
    if (unit === '×') return values.map((value) => `×\u00a0${value}`).join(' / ');
    return values.join(' / ') + (unit ? `\u00a0${unit}` : '') + this.ratio(group);
  }

  // " (0.43 yardsticks)" beside figures in seconds; '' where the machine was not measured with them, or does not matter.
  ratio(group) {
    const [{ id, of = id, unit, parts = [] }] = group;
    if (!kSecondsOf[unit] || kOfMotions.has(of) || parts.length !== 1) return '';
    return inYardsticks(group.map(({ value }) => value), unit, this.parts[parts[0]]?.yardstick);
  }

  keys(id) {
    return this.group(id).map((figure) => keyText(figure.key ?? '')).join(' / ');
  }

  // Replaces each {id} of a text by its figure; null if none of them was measured.
  fill(template) {
    const ids = [...template.matchAll(/\{(?!keys:)([^}]+)\}/g)].map((m) => m[1]);
    if (ids.length && ids.every((id) => this.text(id) === null)) return null;
    return template.replace(/\{(keys:)?([^}]+)\}/g, (_, keys, id) => (keys ? this.keys(id) : this.text(id) ?? kNotMeasured)).replace(/,(?: at)? *(?: Mbit\/s)?$/, '');
  }

  // Tests a goal: true, false, or null if its figure was not measured.
  met({ of, min = -Infinity, max = Infinity }) {
    const group = this.group(of);
    return group.length ? group.every(({ value }) => value !== null && value >= min && value <= max) : null;
  }

  // Returns the restriction of a verdict: a quick run has measured one motion only.
  scope(run) {
    return this.runs[run]?.quick ? ' on the one motion of a quick run' : '';
  }

  // Returns the figures that got worse since an earlier run by more than rounding.
  worse() {
    return this.figures.filter(({ better, value, before, digits }) => typeof before === 'number' && value !== null && better &&
      fixed(value, digits) !== fixed(before, digits) && (better === 'more' ? value < before : value > before));
  }
}
