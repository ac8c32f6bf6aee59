// SPDX-License-Identifier: Apache-2.0
// Polynomial expansion (Farnebäck 2003), weighted moments along y: luma times 1, y, y².
layout(location = 0) out vec4 o_a;
layout(location = 1) out vec4 o_b;
uniform sampler2D u_luma;
uniform vec4 u_taps[8];  // weight, times distance, times distance²
uniform int u_side;      // taps each side

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  int last = textureSize(u_luma, 0).y - 1;
  vec2 luma = texelFetch(u_luma, at, 0).xy;
  vec3 a = vec3(luma.x * u_taps[0].x, 0.0, 0.0), b = vec3(luma.y * u_taps[0].x, 0.0, 0.0);
  for (int k = 1; k <= u_side; ++k) {
    vec2 low = texelFetch(u_luma, ivec2(at.x, max(at.y - k, 0)), 0).xy;
    vec2 high = texelFetch(u_luma, ivec2(at.x, min(at.y + k, last)), 0).xy;
    vec2 sum = high + low, difference = high - low;
    a += u_taps[k].xyz * vec3(sum.x, difference.x, sum.x);
    b += u_taps[k].xyz * vec3(sum.y, difference.y, sum.y);
  }
  o_a = vec4(a, 0.0);
  o_b = vec4(b, 0.0);
}
