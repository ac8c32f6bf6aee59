// SPDX-License-Identifier: Apache-2.0
// Luma and coverage of both pictures, premultiplied. Pictures of another size are sampled with their filter.
in vec2 v_uv;
out vec4 o_luma;
uniform sampler2D u_a, u_b;
uniform vec2 u_size;  // target size
const vec3 kLuma = vec3(0.299, 0.587, 0.114);

vec4 picture(sampler2D from) {
  return vec2(textureSize(from, 0)) == u_size ? texelFetch(from, ivec2(gl_FragCoord.xy), 0) : texture(from, v_uv);
}

void main() {
  vec4 a = picture(u_a), b = picture(u_b);
  o_luma = vec4(dot(a.rgb, kLuma), dot(b.rgb, kLuma), a.a, b.a);
}
