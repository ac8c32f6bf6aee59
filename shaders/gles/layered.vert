// SPDX-License-Identifier: Apache-2.0
// Corners of the character, in its frame. Each drawn member m has its texture coordinates and labels, and a seam mask
// per rank (algorithms/rendering.md).
#include "layered_vertex.glsl"

void main() { setCorner(); }
