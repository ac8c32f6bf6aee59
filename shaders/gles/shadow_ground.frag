// SPDX-License-Identifier: Apache-2.0
// Premultiplied black, fading out radially before the quad ends.
in vec2 v_local;
out vec4 o_color;
uniform sampler2D u_occlusion;
uniform float u_strength;
const float kContactShare = 0.75;
const float kBodyShare = 0.6;

void main() {
  vec2 occlusion = texture(u_occlusion, v_local * 0.5 + 0.5).rg;
  float darkness = 1.0 - (1.0 - kContactShare * occlusion.r) * (1.0 - kBodyShare * occlusion.g);
  float fade = 1.0 - smoothstep(0.6, 1.0, length(v_local));
  o_color = vec4(0.0, 0.0, 0.0, u_strength * darkness * fade);
}
