// SPDX-License-Identifier: Apache-2.0
// Corners of the character. Each drawn member m has its texture coordinates and labels, and a seam mask per rank
// (ALGORITHMS 3.2). Everything is in the character's frame.
#include "layered_vertex.glsl"

void main() { setCorner(); }
