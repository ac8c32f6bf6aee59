// SPDX-License-Identifier: Apache-2.0
// Transfers fields from the previous surface: takes those of the nearest vertex in the surrounding cells, or the aims
// if there is none. A texel per vertex.
#include "field_neighbours.glsl"
#include "field_box.glsl"
uniform vec3 u_box_min;      // box of the previous surface
uniform usampler2D u_cells;
uniform sampler2D u_places;  // vertices of the previous surface
uniform sampler2D u_before_low;
uniform sampler2D u_before_high;
uniform sampler2D u_aims_low;
uniform sampler2D u_aims_high;
layout(location = 0) out vec4 o_low;
layout(location = 1) out vec4 o_high;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  o_low = texelFetch(u_aims_low, here, 0);
  o_high = texelFetch(u_aims_high, here, 0);
  int vertex = vertexHere();
  if (vertex >= u_vertex_count) return;
  vec3 place = fetchPosition(vertex) - u_box_min;
  ivec3 middle = cellOf(place);
  int found = -1;
  float least = 1e9;
  for (int i = 0; i < 27; ++i) {
    ivec3 cell = middle + ivec3(i % 3, i / 3 % 3, i / 9) - 1;
    if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(CELLS)))) continue;
    int candidate = int(texelFetch(u_cells, cellTexel(cell), 0).r) - 1;
    if (candidate < 0) continue;
    float far = distance(place, texelFetch(u_places, tableTexel(candidate), 0).xyz);
    if (far < least) least = far, found = candidate;
  }
  if (found < 0) return;
  o_low = texelFetch(u_before_low, tableTexel(found), 0);
  o_high = texelFetch(u_before_high, tableTexel(found), 0);
}
