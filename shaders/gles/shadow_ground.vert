// SPDX-License-Identifier: Apache-2.0
// Two triangles on the ground plane, counter-clockwise seen from above. Draw 6 vertices.
uniform mat4 u_clip_from_character;
uniform vec3 u_eye;
uniform vec4 u_ground;  // centre x, centre z, half extent (m), ground y (m)
out vec2 v_local;       // -1..1

const float kNearer = 0.003;  // share of the way to the eye, in front of a scene's floor

void main() {
  const vec2 corners[6] = vec2[6](vec2(-1, -1), vec2(-1, 1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(1, -1));
  v_local = corners[gl_VertexID];
  vec2 xz = u_ground.xy + u_ground.z * v_local;
  gl_Position = u_clip_from_character * vec4(mix(vec3(xz.x, u_ground.w, xz.y), u_eye, kNearer), 1.0);
}
