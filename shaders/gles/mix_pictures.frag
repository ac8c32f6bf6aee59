// SPDX-License-Identifier: Apache-2.0
// Mixes two premultiplied pictures of one mesh and view. FLOW: 4DVT Eq. 7 corrected (algorithms/alignment.md).
in vec2 v_uv;
out vec4 o_color;
uniform sampler2D u_first;
uniform sampler2D u_second;
uniform float u_share;  // share of the second

#ifdef FLOW
uniform sampler2D u_flow;  // pixels: first(p) ~ second(p + flow)

vec3 straight(vec4 color) { return color.rgb / max(color.a, 1.0 / 255.0); }

// Returns straight colour; `plain` where a warped picture leaves the character.
vec3 warped(vec3 plain) {
  vec2 flow = texelFetch(u_flow, ivec2(gl_FragCoord.xy), 0).xy / vec2(textureSize(u_first, 0));
  vec4 first = texture(u_first, v_uv - u_share * flow);
  vec4 second = texture(u_second, v_uv + (1.0 - u_share) * flow);
  return mix(plain, mix(straight(first), straight(second), u_share), min(first.a, second.a));
}
#endif

void main() {
  o_color = mix(texture(u_first, v_uv), texture(u_second, v_uv), u_share);
#ifdef FLOW
  o_color.rgb = o_color.a * warped(straight(o_color));
#endif
}
