// SPDX-License-Identifier: Apache-2.0
// R: contact, fades within centimetres above the ground. G: body, fades within about a metre. Lengths for a person.
in float v_height_m;
uniform float u_length_scale;
out vec4 o_occlusion;
const float kContactFade_m = 0.08;
const float kBodyFade_m = 0.8;

void main() {
  float height_m = v_height_m / u_length_scale;
  o_occlusion = vec4(exp(-height_m / kContactFade_m), exp(-height_m / kBodyFade_m), 0.0, 1.0);
}
