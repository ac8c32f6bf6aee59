// SPDX-License-Identifier: Apache-2.0
// One direction of a Gaussian blur with a width per channel.
in vec2 v_uv;
out vec4 o_occlusion;
uniform sampler2D u_occlusion;
uniform vec2 u_step;   // one tap in texture coordinates, along the direction
uniform vec2 u_sigma;  // taps: contact, body
const int kTaps = 12;  // each side

void main() {
  vec2 sum = vec2(0.0), total = vec2(0.0);
  for (int tap = -kTaps; tap <= kTaps; ++tap) {
    vec2 t = float(tap) / u_sigma;
    vec2 weight = exp(-0.5 * t * t);
    sum += weight * texture(u_occlusion, v_uv + float(tap) * u_step).rg;
    total += weight;
  }
  o_occlusion = vec4(sum / total, 0.0, 1.0);
}
