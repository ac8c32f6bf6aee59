// SPDX-License-Identifier: Apache-2.0
// Draws native/layering.txt as SVG: a box per folder, bottom → top; a line to each folder below that it may include,
// unless it reaches that through another one; a thick line along the data flow of a capture.
// parseLayering(text) → { flow, folders: [[name, [allowed]]] }; layeringPicture(text) → SVG.

/** Parses lines "folder: allowed", groups "@name: folders" and "flow: folders". Throws for an unknown group. */
export function parseLayering(text) {
  const groups = new Map(), folders = [];
  let flow = [];
  for (const line of text.split('\n')) {
    const [, name, rest] = /^([^#:\s]+):(.*)$/.exec(line) ?? [];
    if (!name) continue;
    const words = rest.trim().split(/\s+/).filter(Boolean).flatMap((word) => {
      if (!word.startsWith('@')) return [word];
      if (!groups.has(word)) throw new Error(`native/layering.txt: ${name} names the group ${word}, which no line above defines`);
      return groups.get(word);
    });
    if (name === 'flow') flow = words;
    else if (name.startsWith('@')) groups.set(name, words);
    else folders.push([name, words]);
  }
  return { flow, folders };
}

// Merges the folders of each top folder into one box. Returns names → boxes that a box may include.
function boxesOf(folders) {
  const top = (name) => name.split('/')[0];
  const boxes = new Map();
  for (const [name, allowed] of folders) {
    const box = boxes.get(top(name)) ?? boxes.set(top(name), new Set()).get(top(name));
    for (const below of allowed) if (top(below) !== top(name)) box.add(top(below));
  }
  return boxes;
}

// Computes the transitive closure: all boxes that a box can reach.
function reachOf(boxes) {
  const reach = new Map();
  const visit = (name, path) => {
    if (reach.has(name) || path.includes(name)) return reach.get(name) ?? new Set();
    const out = new Set();
    for (const below of boxes.get(name) ?? []) {
      out.add(below);
      for (const further of visit(below, [...path, name])) out.add(further);
    }
    return reach.set(name, out).get(name);
  };
  for (const name of boxes.keys()) visit(name, []);
  return reach;
}

const kColumn = 110, kMinWidth = 440, kRow = 76, kBox = { width: 98, height: 36 };

// Rows of names, bottom first: a box stands one row above the highest box that it may include.
function rowsOf(boxes) {
  const rank = new Map();
  const rankOf = (name, path = []) => {
    if (rank.has(name) || path.includes(name)) return rank.get(name) ?? 0;
    const below = [...(boxes.get(name) ?? [])].map((other) => rankOf(other, [...path, name]) + 1);
    return rank.set(name, Math.max(0, ...below)).get(name);
  };
  const rows = [];
  for (const name of boxes.keys()) (rows[rankOf(name)] ??= []).push(name);
  return rows;
}

const kStyle = `
  text { font: 500 15px system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; text-anchor: middle; fill: #26272a; }
  rect { fill: #fff; stroke: #a9a7a3; }
  path { fill: none; stroke: #b9b7b3; stroke-width: 1.25; }
  .flow { stroke: #2f63c8; stroke-width: 4; stroke-linejoin: round; opacity: .75; }
  .onflow { stroke: #2f63c8; stroke-width: 2.5; }
  marker path { fill: #2f63c8; stroke: none; }
  @media (prefers-color-scheme: dark) {
    text { fill: #f0efed; } rect { fill: #3a3b3f; stroke: #77787d; } path { stroke: #66676c; }
    .flow, .onflow { stroke: #8fb4ff; } marker path { fill: #8fb4ff; }
  }`;

export function layeringPicture(text) {
  const { flow, folders } = parseLayering(text);
  const boxes = boxesOf(folders), reach = reachOf(boxes), rows = rowsOf(boxes);
  const width = Math.max(kMinWidth, ...rows.map((names) => names.length * kColumn));
  const height = rows.length * kRow, place = new Map();
  rows.forEach((names, row) => names.forEach((name, i) => place.set(name, {
    x: Math.round((width * (i + 0.5)) / names.length + (names.length === 1 ? ((row % 3) - 1) * kColumn : 0)),
    y: Math.round(height - kRow * (row + 0.5)),
  })));
  const lines = [...boxes].flatMap(([name, below]) => [...below]
    .filter((other) => ![...below].some((between) => between !== other && reach.get(between).has(other)))
    .map((other) => [place.get(name), place.get(other)]));
  const line = ([from, to]) => `<path d="M${from.x} ${from.y + kBox.height / 2}L${to.x} ${to.y - kBox.height / 2}"/>`;
  const way = flow.filter((name) => place.has(name)).map((name) => place.get(name));
  const arrows = way.slice(1).map((to, i) => arrow(way[i], to));
  const box = ([name, { x, y }]) => `<rect x="${x - kBox.width / 2}" y="${y - kBox.height / 2}" width="${kBox.width}" height="${kBox.height}" rx="8"` +
    `${flow.includes(name) ? ' class="onflow"' : ''}/><text x="${x}" y="${y + 5}">${name}</text>`;
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" role="img" aria-label="Folders of native/, bottom to top, and the way of a capture: ${flow.join(', ')}">
<!-- Made by site/docs/make.mjs from native/layering.txt. -->
<style>${kStyle}
</style>
<defs><marker id="head" viewBox="0 0 10 10" refX="8" refY="5" markerWidth="4" markerHeight="4" orient="auto"><path d="M0 0L10 5L0 10z"/></marker></defs>
${lines.map(line).join('\n')}
${arrows.join('\n')}
${[...place].map(box).join('\n')}
</svg>
`;
}

// Draws a line between the borders of two boxes.
function arrow(from, to) {
  const leave = border(from, to), arrive = border(to, from);
  return `<path class="flow" marker-end="url(#head)" d="M${leave.x} ${leave.y}L${arrive.x} ${arrive.y}"/>`;
}

function border(box, towards) {
  const dx = towards.x - box.x, dy = towards.y - box.y;
  const share = Math.min(kBox.width / 2 / Math.max(Math.abs(dx), 1e-6), kBox.height / 2 / Math.max(Math.abs(dy), 1e-6));
  return { x: Math.round(box.x + dx * share), y: Math.round(box.y + dy * share) };
}
