// SPDX-License-Identifier: Apache-2.0
// A picture over the whole viewport. Memory row 0 is its top; DRAWN: a drawn picture, y up.
in vec2 v_uv;
out vec4 o_color;
uniform sampler2D u_background;

#ifdef DRAWN
void main() { o_color = texture(u_background, v_uv); }
#else
void main() { o_color = texture(u_background, vec2(v_uv.x, 1.0 - v_uv.y)); }
#endif
