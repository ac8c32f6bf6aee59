// SPDX-License-Identifier: Apache-2.0
// A figure's mesh of either kind (INDEXED: surfaces), with the same coverage as the figure's unstyled draw.
#include "character_vertex.glsl"
uniform mat4 u_clip_from_character;
centroid out vec3 v_normal;  // character's frame
invariant gl_Position;

void main() {
  int vertex = vertexOf(gl_VertexID);
  v_normal = fetchNormal(vertex);
  gl_Position = u_clip_from_character * vec4(fetchPosition(vertex), 1.0);
}
