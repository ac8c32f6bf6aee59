// SPDX-License-Identifier: Apache-2.0
// Blended over what is there. Opacity 0 keeps the colour and only writes depth.
in vec3 v_color;
out vec4 o_color;
uniform float u_opacity;

void main() { o_color = u_opacity * vec4(v_color, 1.0); }
