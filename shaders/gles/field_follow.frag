// SPDX-License-Identifier: Apache-2.0
// Moves fields towards their aims, a texel per vertex (M4D Eq. 5).
uniform sampler2D u_before_low;
uniform sampler2D u_before_high;
uniform sampler2D u_aims_low;
uniform sampler2D u_aims_high;
uniform vec4 u_keeps_low;   // per slot: 1, or 0 to restart its field from 0
uniform vec4 u_keeps_high;
uniform float u_share;      // share of the way to the aims
layout(location = 0) out vec4 o_low;
layout(location = 1) out vec4 o_high;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 aims_low = texelFetch(u_aims_low, here, 0), aims_high = texelFetch(u_aims_high, here, 0);
  o_low = aims_low;
  o_high = aims_high;
  if (u_share >= 1.0) return;  // uninitialised tables may hold NaN, which mix would propagate
  o_low = mix(u_keeps_low * texelFetch(u_before_low, here, 0), aims_low, u_share);
  o_high = mix(u_keeps_high * texelFetch(u_before_high, here, 0), aims_high, u_share);
}
