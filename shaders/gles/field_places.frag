// SPDX-License-Identifier: Apache-2.0
// Position of each vertex from the box's minimum corner, metres, a texel per vertex.
#include "field_neighbours.glsl"
uniform vec3 u_box_min;
out vec4 o_place;

void main() {
  int vertex = vertexHere();
  o_place = vertex < u_vertex_count ? vec4(fetchPosition(vertex) - u_box_min, 1.0) : vec4(0.0);
}
