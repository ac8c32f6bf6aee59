// SPDX-License-Identifier: Apache-2.0
// Scene mesh, blended over the target. Mode 0 keeps the colour and writes depth only; 1 draws the corners' colour; 2
// uses that colour as texture coordinates of the picture.
in vec3 v_color;
out vec4 o_color;
uniform float u_mode;
uniform sampler2D u_picture;

void main() { o_color = u_mode > 1.0 ? texture(u_picture, v_color.xy) : u_mode * vec4(v_color, 1.0); }
