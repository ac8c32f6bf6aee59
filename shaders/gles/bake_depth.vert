// SPDX-License-Identifier: Apache-2.0
// The mesh from one camera. Draw 3 * face_count vertices.
#include "bake_mesh.glsl"
uniform mat4 clip_from_world;

void main() { gl_Position = clip_from_world * vec4(positionOf(cornerOf(gl_VertexID)), 1.0); }
