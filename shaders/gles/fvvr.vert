// SPDX-License-Identifier: Apache-2.0
// The mesh as the view sees it. Draw 3 * face_count vertices.
#include "fvvr_mesh.glsl"
uniform mat4 u_clip_from_world;
centroid out vec3 v_point;   // world, metres
centroid out vec3 v_normal;

void main() {
  int vertex = vertexOf(gl_VertexID);
  v_point = positionOf(vertex);
  v_normal = normalOf(vertex);
  gl_Position = u_clip_from_world * vec4(v_point, 1.0);
}
