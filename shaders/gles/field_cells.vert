// SPDX-License-Identifier: Apache-2.0
// Writes every vertex into its cell, by a triangle round one texel's centre. Draw 3 vertices per vertex.
#include "field_box.glsl"
uniform sampler2D u_places;  // a texel per vertex, metres
flat out uint v_vertex;

void main() {
  int vertex = gl_VertexID / 3, corner = gl_VertexID % 3;
  vec2 texel = vec2(cellTexel(cellOf(texelFetch(u_places, tableTexel(vertex), 0).xyz))) + 0.5;
  texel += vec2(corner == 1 ? 0.8 : -0.4, corner == 2 ? 0.8 : -0.4);
  v_vertex = uint(vertex);
  gl_Position = vec4(texel * (2.0 / float(CELL_TEXELS)) - 1.0, 0.0, 1.0);
}
