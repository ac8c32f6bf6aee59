// SPDX-License-Identifier: Apache-2.0
// Band-limited reconstruction (CTCS00, plenoptic sampling): pictures of cameras this far apart carry no detail
// finer than the parallax that the surface's uncertainty makes between neighbours, so each picture is averaged over a
// square of that side, from wherever one looks. The neighbour is the nearest other camera of this draw, by angle at the
// point. Weights: the lumigraph's.
#define OWN_COLOR
#include "camera_lumigraph.glsl"
uniform float u_depth_uncertainty;  // of the surface along a ray, to either side, metres

const int kTaps = 4;  // along each side; each is a mean over about two texels

vec4 cameraColor(vec3 point, vec3 to_eye, vec3 at, int i) {
  vec3 ray = normalize(u_centres[i].xyz - point);
  float apart = kOpposite;  // radians
  for (int k = 0; k < CAMERAS; ++k)
    if (k != i) apart = min(apart, angleBetween(ray, normalize(u_centres[k].xyz - point)));
  float parallax_m = 2.0 * u_depth_uncertainty * sin(apart);  // 0 if there is one camera alone
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
