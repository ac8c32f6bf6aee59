// SPDX-License-Identifier: Apache-2.0
// Blended over what is there. Mode 0 keeps the colour and only writes depth, 1 draws the corners' colour, with 2 that is
// a place in the picture.
in vec3 v_color;
out vec4 o_color;
uniform float u_mode;
uniform sampler2D u_picture;

void main() { o_color = u_mode > 1.0 ? texture(u_picture, v_color.xy) : u_mode * vec4(v_color, 1.0); }
