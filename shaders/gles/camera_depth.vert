// SPDX-License-Identifier: Apache-2.0
// A camera's depth map with offset multi-draw (LVDT 2, step 2): the mesh drawn COPIES times, unmoved and moved by a
// texel along the diagonals, into one depth buffer. Draw COPIES * u_corner_count vertices.
#include "character_vertex.glsl"
uniform mat4 u_clip_from_character;
uniform int u_corner_count;
uniform vec2 u_clip_per_texel;

const vec2 kOffsets[5] = vec2[5](vec2(0), vec2(-1), vec2(1, -1), vec2(-1, 1), vec2(1));  // texels

void main() {
  int copy = gl_VertexID / u_corner_count;
  vec4 clip = u_clip_from_character * vec4(fetchPosition(vertexOf(gl_VertexID - copy * u_corner_count)), 1.0);
  clip.xy += kOffsets[copy] * u_clip_per_texel * clip.w;
  gl_Position = clip;
}
