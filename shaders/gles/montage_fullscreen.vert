// SPDX-License-Identifier: Apache-2.0
// One triangle over the whole viewport. Draw 3 vertices.
void main() { gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0.0, 1.0); }
