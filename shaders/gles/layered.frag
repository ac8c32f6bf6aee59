// SPDX-License-Identifier: Apache-2.0
// LVDT Eq. 3-4 with the corrected sign, per-fragment rays and seam feathering, for each source; sources are blended by
// their weights. Blends encoded values, as the paper does.
#define VARYING in
#include "layered_varyings.glsl"
#include "picture.glsl"
out vec4 o_color;

uniform vec4 u_sources[SOURCES];  // member, weight
#ifdef PAPER_WEIGHTS
uniform vec3 u_view_axis;  // unit, of the viewing camera
uniform vec4 u_camera_forwards[MAX_CAMERAS];
#else
uniform vec3 u_eye;
uniform vec4 u_camera_centres[MAX_CAMERAS];
#endif
#ifdef SHARPENED
uniform float u_view_exponent;  // sharpens the view term; without: 1, the paper
#endif

// Below this sum of weights the first slot takes over.
const float kLeastSum = 1e-4;

uint labelOf(int source, int slot) { return (v_labels[source] >> uint(5 * slot)) & kEmpty; }

float slotWeight(int source, int slot, vec3 normal, vec3 to_eye) {
  int i = source * LAYERS + slot;
  float mask = v_masks[i / 4][i % 4];
  if (mask <= 0.0) return 0.0;
#ifdef PAPER_WEIGHTS
  vec3 direction = -u_camera_forwards[labelOf(source, slot)].xyz;
#else
  vec3 direction = normalize(u_camera_centres[labelOf(source, slot)].xyz - v_point);
#endif
  float facing = max(dot(normal, direction), 0.0);
  float viewing = max(dot(direction, to_eye), 0.0);
#ifdef SHARPENED
  viewing = pow(viewing, u_view_exponent);
#endif
  return mask * facing * viewing;
}

// Sum 1.
void slotShares(int source, vec3 normal, vec3 to_eye, out float shares[LAYERS]) {
  float sum = 0.0;
  for (int slot = 0; slot < LAYERS; ++slot) {
    shares[slot] = slotWeight(source, slot, normal, to_eye);
    sum += shares[slot];
  }
  float missing = max(kLeastSum - sum, 0.0);
  shares[0] += missing;
  sum += missing;
  for (int slot = 0; slot < LAYERS; ++slot) shares[slot] /= sum;
}

#ifdef ALIGNED
uniform float u_detail;  // what is put back of the contrast that the mean of several looks loses in its detail
const float kReach = 3.0;
#endif

// One member. ALIGNED: with what its share of the detail needs, against both neighbours on a diagonal, which turns
// from source to source.
vec3 sourceColor(int source, vec3 normal, vec3 to_eye) {
  float shares[LAYERS];
  slotShares(source, normal, to_eye, shares);
  vec3 color = vec3(0.0);
#ifdef ALIGNED
  int main_slot = 0;
  vec3 main_color = vec3(0.0);
#endif
  for (int slot = 0; slot < LAYERS; ++slot) {
    if (shares[slot] <= 0.0) continue;
    vec3 layer = sampleLayer(source * LAYERS + slot, v_uv[source]);
    color += shares[slot] * layer;
#ifdef ALIGNED
    if (shares[slot] >= shares[main_slot]) {
      main_slot = slot;
      main_color = layer;
    }
#endif
  }
#ifdef ALIGNED
  vec2 diagonal = vec2(kReach, source % 2 == 0 ? kReach : -kReach);
  color += u_detail * (dot(main_color, kLuma) - lumaBeside(source * LAYERS + main_slot, v_uv[source], diagonal));
#endif
  return color;
}

#ifdef DEBUG_VIEW
uniform int u_debug_layer;

vec3 labelColor(uint label) {
  if (label == kEmpty) return vec3(0.25);
  vec3 hue = fract(float(label) * 0.618034 + vec3(0.0, 2.0, 1.0) / 3.0);
  return 0.15 + 0.85 * clamp(abs(hue * 6.0 - 3.0) - 1.0, 0.0, 1.0);
}

vec3 debugColor(vec3 normal, vec3 to_eye) {
#if DEBUG_VIEW == 1
  return labelColor(labelOf(0, u_debug_layer));
#elif DEBUG_VIEW == 2
  return sampleLayer(u_debug_layer, v_uv[0]);
#elif DEBUG_VIEW == 3
  float shares[LAYERS];
  slotShares(0, normal, to_eye, shares);
  vec3 shown = vec3(0.0);
  for (int slot = 0; slot < min(LAYERS, 3); ++slot) shown[slot] = shares[slot];
  return shown;
#else
  return normal * 0.5 + 0.5;
#endif
}
#endif

void main() {
  vec3 normal = normalize(v_normal);
#ifdef PAPER_WEIGHTS
  vec3 to_eye = -u_view_axis;
#else
  vec3 to_eye = normalize(u_eye - v_point);
#endif
#ifdef DEBUG_VIEW
  o_color = vec4(debugColor(normal, to_eye), 1.0);
#else
  vec3 color = vec3(0.0);
  for (int source = 0; source < SOURCES; ++source) color += u_sources[source].y * sourceColor(source, normal, to_eye);
  o_color = vec4(color, 1.0);
#endif
}
