// SPDX-License-Identifier: Apache-2.0
// White on the surface.
out vec4 o_color;

void main() { o_color = vec4(1.0); }
