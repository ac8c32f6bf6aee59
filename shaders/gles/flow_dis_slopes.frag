// SPDX-License-Identifier: Apache-2.0
// Both lumas, and the slope of the first picture's luma.
out vec4 o_slopes;
uniform sampler2D u_luma;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), low = max(at - 1, 0), high = min(at + 1, textureSize(u_luma, 0) - 1);
  vec2 ends = vec2(texelFetch(u_luma, ivec2(high.x, at.y), 0).x, texelFetch(u_luma, ivec2(at.x, high.y), 0).x);
  vec2 starts = vec2(texelFetch(u_luma, ivec2(low.x, at.y), 0).x, texelFetch(u_luma, ivec2(at.x, low.y), 0).x);
  o_slopes = vec4(texelFetch(u_luma, at, 0).xy, (ends - starts) / vec2(high - low));
}
