// SPDX-License-Identifier: Apache-2.0
// Vertex of the cell, counted from 1.
flat in uint v_vertex;
out uint o_vertex;

void main() { o_vertex = v_vertex + 1u; }
