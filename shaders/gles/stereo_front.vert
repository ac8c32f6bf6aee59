// SPDX-License-Identifier: Apache-2.0
// The hull from a reference camera, with its depth in metres along the optical axis. Draw the faces' indices.
#include "tables.glsl"
uniform sampler2D u_positions;
uniform mat4 u_clip_from_world;
out float v_depth;

void main() {
  gl_Position = u_clip_from_world * vec4(texelFetch(u_positions, tableTexel(gl_VertexID), 0).xyz, 1.0);
  v_depth = gl_Position.w;
}
