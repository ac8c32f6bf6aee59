// SPDX-License-Identifier: Apache-2.0
// Sums over a table, in units of 1/256: of each row, or of the single column of row sums.
uniform sampler2D u_before_low;
uniform sampler2D u_before_high;
uniform int u_rows;  // rows in use
layout(location = 0) out vec4 o_low;
layout(location = 1) out vec4 o_high;

void main() {
  int columns = textureSize(u_before_low, 0).x;
  o_low = o_high = vec4(0.0);
  for (int i = 0; i < (columns > 1 ? columns : u_rows); ++i) {
    ivec2 at = columns > 1 ? ivec2(i, int(gl_FragCoord.y)) : ivec2(0, i);
    o_low += texelFetch(u_before_low, at, 0) / 256.0;
    o_high += texelFetch(u_before_high, at, 0) / 256.0;
  }
}
