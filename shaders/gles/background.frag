// SPDX-License-Identifier: Apache-2.0
// A picture over the whole viewport. Its memory row 0 is the top; DRAWN: it was drawn, y up.
in vec2 v_uv;
out vec4 o_color;
uniform sampler2D u_background;

#ifdef DRAWN
void main() { o_color = texture(u_background, v_uv); }
#else
void main() { o_color = texture(u_background, vec2(v_uv.x, 1.0 - v_uv.y)); }
#endif
