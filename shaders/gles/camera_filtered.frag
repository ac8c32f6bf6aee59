// SPDX-License-Identifier: Apache-2.0
// Filtered blending (EM07), as those describe it who build on it: FT 2 says that it considers the
// viewpoint too, B14 that it filters each picture in one dimension, as wide as the surface is uncertain. So what
// lies on the view's ray within the uncertainty is a line in a camera's picture, and the camera's colour is that line's
// mean: a point, and sharp, where view and camera look along the same ray; the longer, the further they are apart.
// Weights: the lumigraph's. The paper itself was not at hand; its own weights may differ.
#define OWN_COLOR
#include "camera_lumigraph.glsl"
uniform float u_depth_uncertainty;  // of the surface along the ray, to either side, metres

const int kTaps = 8;  // along the line; each is a mean over about two texels

vec2 pixelOf(vec3 point, int i) {
  vec3 p = (u_pixel_from_character[i] * vec4(point, 1.0)).xyz;
  return p.xy / p.z;
}

vec4 cameraColor(vec3 point, vec3 to_eye, vec3 at, int i) {
  vec3 reach = u_depth_uncertainty * to_eye;
  vec2 first = pixelOf(point - reach, i), last = pixelOf(point + reach, i);
  vec4 sum = vec4(0.0);
  for (int k = 0; k < kTaps; ++k) {
    vec4 texel = pictureColor(mix(first, last, (float(k) + 0.5) / float(kTaps)), i);
    sum += vec4(texel.rgb * texel.a, texel.a);
  }
  return sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : vec4(0.0);
}
