// SPDX-License-Identifier: Apache-2.0
// The character, with the same coverage as layered.vert.
#include "character_vertex.glsl"
uniform mat4 u_clip_from_character;
invariant gl_Position;

void main() { gl_Position = u_clip_from_character * vec4(fetchPosition(fetchCorner(gl_VertexID).vertex), 1.0); }
