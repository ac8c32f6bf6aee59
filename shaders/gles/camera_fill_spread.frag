// SPDX-License-Identifier: Apache-2.0
// One Jacobi step of Laplace's equation on the surface: unseen vertices take the mean of their neighbours' colours.
#include "tables.glsl"
uniform sampler2D u_seen;         // a texel per vertex (camera_fill_seen.frag)
uniform sampler2D u_before;       // previous step, a texel per vertex
uniform usampler2D u_neighbours;  // [vertex] start of its list, and the end; then the lists
uniform int u_vertex_count;
out vec4 o_color;

uint neighbourTexel(int i) { return texelFetch(u_neighbours, tableTexel(i), 0).r; }

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  o_color = texelFetch(u_seen, here, 0);
  int vertex = here.y * TABLE_WIDTH + here.x;
  if (o_color.a > 0.0 || vertex >= u_vertex_count) return;
  vec4 sum = vec4(0.0);
  int end = int(neighbourTexel(vertex + 1));
  for (int i = int(neighbourTexel(vertex)); i < end; ++i) {
    vec4 color = texelFetch(u_before, tableTexel(int(neighbourTexel(i))), 0);
    if (color.a > 0.0) sum += vec4(color.rgb, 1.0);
  }
  if (sum.a > 0.0) o_color = vec4(sum.rgb / sum.a, 1.0);
}
