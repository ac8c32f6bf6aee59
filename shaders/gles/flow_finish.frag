// SPDX-License-Identifier: Apache-2.0
// Flow at the pictures' size, faded where it cannot be known.
in vec2 v_uv;
out vec2 o_flow;
uniform sampler2D u_flow, u_pictures;
uniform float u_gain;

void main() { o_flow = texture(u_flow, v_uv).xy * u_gain * texelFetch(u_pictures, ivec2(gl_FragCoord.xy), 0).a; }
