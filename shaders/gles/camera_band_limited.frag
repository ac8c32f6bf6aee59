// SPDX-License-Identifier: Apache-2.0
// Band-limited reconstruction after plenoptic sampling (CTCS00: Jin-Xiang Chai, Xin Tong, Shing-Chow Chan, Heung-Yeung
// Shum: Plenoptic Sampling. SIGGRAPH, 2000). Cameras at this distance resolve no detail finer than the parallax between
// neighbours due to depth uncertainty, so each picture is averaged over a square of that side, whatever the view. The
// neighbour is the nearest other camera of this draw, by angle at the point. Weights as in camera_lumigraph.glsl.
#define OWN_COLOR
#include "camera_lumigraph.glsl"
uniform float u_depth_uncertainty;  // depth of the surface along a ray, to either side, metres

const int kTaps = 4;  // along each side; each averages about two texels

vec4 cameraColor(vec3 point, vec3 to_eye, vec3 at, int i) {
  vec3 ray = normalize(u_centres[i].xyz - point);
  float apart = kOpposite;  // radians
  for (int k = 0; k < CAMERAS; ++k)
    if (k != i) apart = min(apart, angleBetween(ray, normalize(u_centres[k].xyz - point)));
  float parallax_m = 2.0 * u_depth_uncertainty * sin(apart);  // 0 for a single camera
  float side = parallax_m / (u_pixel_spans[i].x * at.z);      // pixels
  if (side <= 1.0) return pictureColor(at.xy, i);
  vec4 sum = vec4(0.0);
  for (int k = 0; k < kTaps * kTaps; ++k) {
    vec2 tap = (vec2(k % kTaps, k / kTaps) + 0.5) / float(kTaps) - 0.5;
    vec4 texel = pictureColor(at.xy + side * tap, i);
    sum += vec4(texel.rgb * texel.a, texel.a);
  }
  return sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : vec4(0.0);
}
