// SPDX-License-Identifier: Apache-2.0
// White wherever the surface is.
out vec4 o_color;

void main() { o_color = vec4(1.0); }
