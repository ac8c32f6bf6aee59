// SPDX-License-Identifier: Apache-2.0
// Shift of each pixel along its ray: semi-global matching on four paths of limited length, then the sub-plane minimum
// of the sum. H08: Heiko Hirschmüller: Stereo Processing by Semiglobal Matching and Mutual Information. IEEE
// Transactions on Pattern Analysis and Machine Intelligence 30(2), 2008. A small penalty on large shifts resolves
// ambiguous costs.
#include "camera_sweep.glsl"
uniform highp sampler2DArray u_costs;
uniform int u_length;         // path length, pixels
uniform vec3 u_prices;        // penalties: change by one plane, any change, large shift
uniform vec2 u_band;          // first and last plane behind the surface, metres
uniform float u_reach_m;      // metres for a shift of 1
out vec4 o_shift;             // shift in two channels, unused, 1: surface present

const float kWell = 0.016;     // shift with half the penalty, metres for a person
const float kSamePart = 0.03;  // depth difference within one part of a person, metres

vec4 blocks[BLOCKS];  // path costs

float least() {
  vec4 m = blocks[0];
  for (int b = 1; b < BLOCKS; ++b) m = min(m, blocks[b]);
  return min(min(m.x, m.y), min(m.z, m.w));
}

// Advances the path costs by one pixel, without that pixel's own cost.
void advance() {
  float lowest = least();
  vec4 before = vec4(1e3);
  for (int b = 0; b < BLOCKS; ++b) {
    vec4 here = blocks[b], after = b + 1 < BLOCKS ? blocks[b + 1] : vec4(1e3);
    vec4 beside = min(vec4(before.w, here.xyz), vec4(here.yzw, after.x)) + u_prices.x;
    blocks[b] = min(min(here, beside), vec4(lowest + u_prices.y)) - lowest;
    before = here;
  }
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(u_normals, 0) - 1;
  o_shift = vec4(0.0);
  if (!isSurface(here)) return;
  vec4 total[BLOCKS];
  for (int b = 0; b < BLOCKS; ++b) total[b] = texelFetch(u_costs, ivec3(here, b), 0);
  for (int d = 0; d < 4; ++d) {
    ivec2 direction = ivec2(d == 0 ? 1 : d == 1 ? -1 : 0, d == 2 ? 1 : d == 3 ? -1 : 0);
    int length = 0;  // pixels to the border of this part of the surface
    float depth = surfaceDepth(here);
    while (length < u_length) {
      ivec2 at = here + (length + 1) * direction;
      if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last)) || !isSurface(at)) break;
      float next = surfaceDepth(at);
      if (abs(next - depth) > u_length_scale * kSamePart) break;
      depth = next;
      ++length;
    }
    for (int b = 0; b < BLOCKS; ++b) blocks[b] = vec4(0.0);
    for (int i = length; i > 0; --i) {
      for (int b = 0; b < BLOCKS; ++b) blocks[b] += texelFetch(u_costs, ivec3(here + i * direction, b), 0);
      advance();
    }
    for (int b = 0; b < BLOCKS; ++b) total[b] += blocks[b];
  }
  const int planes = 4 * BLOCKS;
  float best = 1e9;
  int chosen = 0;
  for (int k = 0; k < planes; ++k) {
    float offset_m = mix(u_band.x, u_band.y, float(k) / float(planes - 1));
    float away = offset_m * offset_m / (u_length_scale * u_length_scale * kWell * kWell);
    total[k / 4][k % 4] += u_prices.z * away / (1.0 + away);
    if (total[k / 4][k % 4] < best) best = total[k / 4][k % 4], chosen = k;
  }
  float plane = float(chosen);
  if (chosen > 0 && chosen < planes - 1) {
    float before = total[(chosen - 1) / 4][(chosen - 1) % 4], after = total[(chosen + 1) / 4][(chosen + 1) % 4];
    plane += clamp(0.5 * (before - after) / max(before + after - 2.0 * best, 1e-6), -0.5, 0.5);
  }
  float shift = mix(u_band.x, u_band.y, plane / float(planes - 1)) / u_reach_m;
  o_shift = vec4(packedShift(shift), 0.0, 1.0);
}
