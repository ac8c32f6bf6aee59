// SPDX-License-Identifier: Apache-2.0
// Depth in metres.
in float v_depth;
out vec4 o_depth;

void main() { o_depth = vec4(v_depth, 0.0, 0.0, 1.0); }
