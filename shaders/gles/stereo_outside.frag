// SPDX-License-Identifier: Apache-2.0
// Cost 1 in front of everything where cells are closed or the reference has no hull; see stereo_costs.frag for the
// target's layout. Leaves the other fragments to it.
out vec4 o_costs;
uniform highp sampler2D u_front;  // metres, 0: no hull
uniform sampler2D u_cells;        // block below block, CELL pixels a texel, the region's top row first; 0: closed
uniform vec4 u_region;            // reference region: first column, first row, columns, rows

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  int rows = int(u_region.w), block = at.y / rows;
  at.y -= block * rows;
  ivec2 cell = ivec2(at.x, rows - 1 - at.y) / CELL;
  cell.y += block * ((rows + CELL - 1) / CELL);
  if (texelFetch(u_front, at, 0).r > 0.0 && texelFetch(u_cells, cell, 0).r > 0.5) discard;
  gl_FragDepth = 0.0;
  o_costs = vec4(1);
}
