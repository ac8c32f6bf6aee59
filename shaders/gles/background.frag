// SPDX-License-Identifier: Apache-2.0
// A picture whose memory row 0 is the top, over the whole view.
in vec2 v_uv;
out vec4 o_color;
uniform sampler2D u_background;

void main() { o_color = texture(u_background, vec2(v_uv.x, 1.0 - v_uv.y)); }
