// SPDX-License-Identifier: Apache-2.0
// The character from above, orthographic; lower is nearer in depth, so that the lowest surface casts.
#include "character_vertex.glsl"
uniform vec4 u_ground;  // centre x, centre z, half extent (m), ground y (m)
uniform float u_height_m;  // height of the volume that casts
out float v_height_m;

void main() {
  vec3 point = fetchPosition(vertexOf(gl_VertexID));
  v_height_m = max(point.y - u_ground.w, 0.0);
  gl_Position = vec4((point.xz - u_ground.xy) / u_ground.z, 2.0 * clamp(v_height_m / u_height_m, 0.0, 1.0) - 1.0, 1.0);
}
