// SPDX-License-Identifier: Apache-2.0
// Blended over: opacity 0 leaves the colour as it is and writes depth.
in vec3 v_color;
out vec4 o_color;
uniform float u_opacity;

void main() { o_color = u_opacity * vec4(v_color, 1.0); }
