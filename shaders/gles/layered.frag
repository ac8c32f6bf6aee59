// SPDX-License-Identifier: Apache-2.0
// LVDT Eq. 3-4 with the corrected sign, per-fragment rays and seam feathering. Blends encoded values, as the paper does.
#include "picture.glsl"
in vec2 v_uv;
in vec3 v_normal;
in vec3 v_to_eye;
in vec4 v_to_camera[LAYERS];
flat in uint v_labels;
out vec4 o_color;

#ifdef SHARPENED
uniform float u_view_exponent;  // sharpens the view term; without: 1, the paper
#endif

// Below this sum of weights the first slot takes over.
const float kLeastSum = 1e-4;

#ifdef DEBUG_VIEW
uniform int u_debug_layer;

vec3 labelColor(uint label) {
  if (label == 31u) return vec3(0.25);
  vec3 hue = fract(float(label) * 0.618034 + vec3(0.0, 2.0, 1.0) / 3.0);
  return 0.15 + 0.85 * clamp(abs(hue * 6.0 - 3.0) - 1.0, 0.0, 1.0);
}
#endif

float slotWeight(vec4 to_camera, vec3 normal, vec3 to_eye) {
  if (to_camera.w <= 0.0) return 0.0;
  vec3 direction = normalize(to_camera.xyz);
  float facing = max(dot(normal, direction), 0.0);
  float viewing = max(dot(direction, to_eye), 0.0);
#ifdef SHARPENED
  viewing = pow(viewing, u_view_exponent);
#endif
  return to_camera.w * facing * viewing;
}

void main() {
  vec3 normal = normalize(v_normal);
  vec3 to_eye = normalize(v_to_eye);
  float weights[LAYERS];
  float sum = 0.0;
  for (int slot = 0; slot < LAYERS; ++slot) {
    weights[slot] = slotWeight(v_to_camera[slot], normal, to_eye);
    sum += weights[slot];
  }
  float missing = max(kLeastSum - sum, 0.0);
  weights[0] += missing;
  sum += missing;
  vec3 color = vec3(0.0);
  for (int slot = 0; slot < LAYERS; ++slot)
    if (weights[slot] > 0.0) color += weights[slot] * sampleLayer(slot, v_uv);
  o_color = vec4(color / sum, 1.0);

#ifdef DEBUG_VIEW
#if DEBUG_VIEW == 1
  o_color.rgb = labelColor((v_labels >> uint(5 * u_debug_layer)) & 31u);
#elif DEBUG_VIEW == 2
  o_color.rgb = sampleLayer(u_debug_layer, v_uv);
#elif DEBUG_VIEW == 3
  vec3 shares = vec3(0.0);
  for (int slot = 0; slot < min(LAYERS, 3); ++slot) shares[slot] = weights[slot] / sum;
  o_color.rgb = shares;
#else
  o_color.rgb = normal * 0.5 + 0.5;
#endif
#endif
}
