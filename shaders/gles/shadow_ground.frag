// SPDX-License-Identifier: Apache-2.0
// Premultiplied black, fading out radially before the quad ends.
in vec2 v_local;
out vec4 o_color;
uniform sampler2D u_occlusion;
uniform float u_strength;
// Gains that compensate for the blur of a foot's and a body's width.
const vec2 kGain = vec2(1.6, 1.3);
const vec2 kShare = vec2(0.85, 0.7);

void main() {
  vec2 occlusion = texture(u_occlusion, v_local * 0.5 + 0.5).rg;
  vec2 open = 1.0 - kShare * min(kGain * occlusion, 1.0);
  float darkness = 1.0 - open.r * open.g;
  float fade = 1.0 - smoothstep(0.6, 1.0, length(v_local));
  o_color = vec4(0.0, 0.0, 0.0, u_strength * darkness * fade);
}
