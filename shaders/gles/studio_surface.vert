// SPDX-License-Identifier: Apache-2.0
// The actor's surface in one pose. Draw 3 * face_count vertices. Corner table: (uv, vertex, unused).
#include "tables.glsl"
uniform sampler2D corners;
uniform sampler2D positions;  // world, metres
uniform sampler2D normals;
uniform sampler2D rest;       // rest pose, metres: fixed to the material
uniform mat4 clip_from_world;
out vec2 v_uv;
out vec3 v_world, v_normal, v_rest;

void main() {
  vec4 corner = texelFetch(corners, tableTexel(gl_VertexID), 0);
  ivec2 vertex = tableTexel(int(corner.z));
  v_uv = corner.xy;
  v_world = texelFetch(positions, vertex, 0).xyz;
  v_normal = texelFetch(normals, vertex, 0).xyz;
  v_rest = texelFetch(rest, vertex, 0).xyz;
  gl_Position = clip_from_world * vec4(v_world, 1.0);
}
