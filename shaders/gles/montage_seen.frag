// SPDX-License-Identifier: Apache-2.0
// Visibility of each slot's camera at a vertex: 1 if every face there has the camera in its label set. A texel per
// vertex.
#include "montage_slots.glsl"
layout(location = 0) out vec4 o_low;
layout(location = 1) out vec4 o_high;

void main() {
  int vertex = vertexHere();
  uint mask = vertex < u_vertex_count ? maskAt(vertex) : 0u;
  o_low = seen(mask, u_slot_cameras[0]);
  o_high = seen(mask, u_slot_cameras[1]);
}
