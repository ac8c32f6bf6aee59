// SPDX-License-Identifier: Apache-2.0
// R: contact, fades within centimetres above the ground. G: body, fades within about a metre.
in float v_height_m;
out vec4 o_occlusion;
const float kContactFade_m = 0.08;
const float kBodyFade_m = 0.8;

void main() { o_occlusion = vec4(exp(-v_height_m / kContactFade_m), exp(-v_height_m / kBodyFade_m), 0.0, 1.0); }
