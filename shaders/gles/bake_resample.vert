// SPDX-License-Identifier: Apache-2.0
// Faces of one layer and one camera, drawn at their UVs. Draw 3 vertices per listed face.
#include "bake_mesh.glsl"
uniform highp usampler2D face_list;
uniform int first_entry;
out vec3 v_point_in_world;
flat out vec3 v_normal_in_world;

void main() {
  int entry = first_entry + gl_VertexID / 3;
  int face = int(texelFetch(face_list, tableTexel(entry), 0).r);
  vec4 own = cornerOf(3 * face + gl_VertexID % 3);
  vec3 a = positionOf(cornerOf(3 * face)), b = positionOf(cornerOf(3 * face + 1)), c = positionOf(cornerOf(3 * face + 2));
  vec3 area_normal = cross(b - a, c - a);
  v_normal_in_world = area_normal / max(length(area_normal), 1e-20);
  v_point_in_world = positionOf(own);
  gl_Position = vec4(2.0 * own.x - 1.0, 1.0 - 2.0 * own.y, 0.0, 1.0);  // UV row 0 is the target's top row
}
