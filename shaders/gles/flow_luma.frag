// SPDX-License-Identifier: Apache-2.0
// Luma and coverage of both pictures, premultiplied.
out vec4 o_luma;
uniform sampler2D u_a, u_b;
const vec3 kLuma = vec3(0.299, 0.587, 0.114);

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 a = texelFetch(u_a, at, 0), b = texelFetch(u_b, at, 0);
  o_luma = vec4(dot(a.rgb, kLuma), dot(b.rgb, kLuma), a.a, b.a);
}
