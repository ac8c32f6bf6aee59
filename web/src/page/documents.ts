// SPDX-License-Identifier: Apache-2.0
// Window and style sheets of an element's document, which is not the script's after a move into a frame or a
// picture-in-picture window. Sheets are constructable, so that the page can have a strict style-src policy.

const sheets = new WeakMap<Document, Map<string, CSSStyleSheet>>();

/** Window that shows the node: the one for observers, animation frames and the pixel ratio. */
export const viewOf = (node: Node): typeof globalThis => (node.ownerDocument?.defaultView as typeof globalThis | null | undefined) ?? globalThis;

/** Adds the style to the node's tree, once; trees of one document share the sheet. Adoption by another document drops it. */
export function adopt(node: Node, css: string): void {
  const root = node.getRootNode() as ShadowRoot, { ownerDocument } = root;
  if (!ownerDocument.defaultView) return; // the document has no window
  let ofDocument = sheets.get(ownerDocument);
  if (!ofDocument) sheets.set(ownerDocument, (ofDocument = new Map()));
  let sheet = ofDocument.get(css);
  if (!sheet) {
    ofDocument.set(css, (sheet = new (viewOf(root).CSSStyleSheet)()));
    sheet.replaceSync(css);
  }
  if (!root.adoptedStyleSheets.includes(sheet)) root.adoptedStyleSheets = [...root.adoptedStyleSheets, sheet];
}
