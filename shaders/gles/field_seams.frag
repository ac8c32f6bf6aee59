// SPDX-License-Identifier: Apache-2.0
// Initial distances: 0 at the vertices of a slot's seam triangles, 1 elsewhere (M4D 4.3).
#include "field_neighbours.glsl"
uniform sampler2D u_seen_low;
uniform sampler2D u_seen_high;
layout(location = 0) out vec4 o_low;
layout(location = 1) out vec4 o_high;

void main() {
  o_low = o_high = vec4(1.0);
  int vertex = vertexHere();
  if (vertex >= u_vertex_count) return;
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 low = step(0.5, texelFetch(u_seen_low, here, 0)), high = step(0.5, texelFetch(u_seen_high, here, 0));
  int end = neighbourTexel(vertex + 1);
  for (int i = neighbourTexel(vertex); i < end; ++i) {
    ivec2 there = tableTexel(neighbourTexel(i));
    o_low *= vec4(equal(low, step(0.5, texelFetch(u_seen_low, there, 0))));
    o_high *= vec4(equal(high, step(0.5, texelFetch(u_seen_high, there, 0))));
  }
}
