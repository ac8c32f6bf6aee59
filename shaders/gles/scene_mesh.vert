// SPDX-License-Identifier: Apache-2.0
// Corners of a SceneMesh, two texels each: position, colour.
#include "tables.glsl"
uniform sampler2D u_corners;
uniform mat4 u_clip_from_world;
out vec3 v_color;

void main() {
  v_color = texelFetch(u_corners, tableTexel(2 * gl_VertexID + 1), 0).rgb;
  gl_Position = u_clip_from_world * vec4(texelFetch(u_corners, tableTexel(2 * gl_VertexID), 0).xyz, 1.0);
}
