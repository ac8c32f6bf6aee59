// SPDX-License-Identifier: Apache-2.0
// Styles of shadow trees. Constructable style sheets, so that the page can have a strict style-src policy.

const sheets = new Map<string, CSSStyleSheet>();

/** Adds the style to the tree, once; trees of one page share the sheet. */
export function adopt(root: ShadowRoot, css: string): void {
  let sheet = sheets.get(css);
  if (!sheet) {
    sheets.set(css, (sheet = new CSSStyleSheet()));
    sheet.replaceSync(css);
  }
  if (!root.adoptedStyleSheets.includes(sheet)) root.adoptedStyleSheets = [...root.adoptedStyleSheets, sheet];
}
