// SPDX-License-Identifier: Apache-2.0
// Window and style sheets of an element's document. It differs from the script's after a move into a frame or a picture-in-picture
// window. The sheets are constructable, so that the page can have a strict style-src policy.

const sheets = new WeakMap<Document, Map<string, CSSStyleSheet>>();

/** The window that shows the node, whose observers, animation frames and pixel ratio apply. */
export const viewOf = (node: Node): typeof globalThis => (node.ownerDocument?.defaultView as typeof globalThis | null | undefined) ?? globalThis;

/** Adds the style to the node's tree, once; trees of one document share the sheet. A tree that is adopted by another document loses its styles. */
export function adopt(node: Node, css: string): void {
  const root = node.getRootNode() as ShadowRoot, { ownerDocument } = root;
  if (!ownerDocument.defaultView) return; // nothing shows it
  let ofDocument = sheets.get(ownerDocument);
  if (!ofDocument) sheets.set(ownerDocument, (ofDocument = new Map()));
  let sheet = ofDocument.get(css);
  if (!sheet) {
    ofDocument.set(css, (sheet = new (viewOf(root).CSSStyleSheet)()));
    sheet.replaceSync(css);
  }
  if (!root.adoptedStyleSheets.includes(sheet)) root.adoptedStyleSheets = [...root.adoptedStyleSheets, sheet];
}
