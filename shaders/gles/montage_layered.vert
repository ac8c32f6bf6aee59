// SPDX-License-Identifier: Apache-2.0
// Variant of layered.vert that passes on, for one drawn member, the field of the camera at each rank.
#include "layered_vertex.glsl"
out vec4 v_fields[(LAYERS + 3) / 4];  // by rank
uniform int u_field_member;           // drawn member that has fields
uniform vec4 u_slot_cameras[2];
uniform sampler2D u_fields_low;       // a texel per vertex, a channel per slot
uniform sampler2D u_fields_high;

// Returns a camera's field; without a slot 1, equal to no seam and a frontal view.
float fieldOf(uint camera, vec4 low, vec4 high) {
  vec4 in_low = vec4(equal(vec4(camera), u_slot_cameras[0])), in_high = vec4(equal(vec4(camera), u_slot_cameras[1]));
  float held = dot(in_low + in_high, vec4(1.0));
  return held > 0.0 ? dot(in_low, low) + dot(in_high, high) : 1.0;
}

void main() {
  setCorner();
  ivec2 at = tableTexel(vertexOf(gl_VertexID));
  vec4 low = texelFetch(u_fields_low, at, 0), high = texelFetch(u_fields_high, at, 0);
  int first = int(u_members[u_field_member].x) * u_face_count;
  uint labels = texelFetch(u_labels, tableTexel(first + gl_VertexID / 3), 0).r;
  for (int rank = 0; rank < LAYERS; ++rank)
    v_fields[rank / 4][rank % 4] = fieldOf((labels >> uint(5 * rank)) & kEmpty, low, high);
}
