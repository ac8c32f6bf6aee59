// SPDX-License-Identifier: Apache-2.0
// Filtered blending (EM07: Martin Eisemann, Marcus Magnor: Filtered Blending: A New, Minimal Reconstruction Filter for
// Ghosting-Free Projective Texturing with Multiple Images. Vision, Modeling, and Visualization (VMV), 2007),
// reconstructed from descriptions in later work, since the paper was unavailable: it considers the viewpoint too (FT 2)
// and filters each picture in one dimension, as wide as the surface is uncertain (B14). The view ray's segment within
// the uncertainty projects to a line in a camera's picture, and the camera's colour is the mean over that line: a
// point, and sharp, where the rays of view and camera coincide, longer with the angle between them. Weights as in
// camera_lumigraph.glsl; the paper's may differ.
#define OWN_COLOR
#include "camera_lumigraph.glsl"
uniform float u_depth_uncertainty;  // depth of the surface along the ray, to either side, metres

const int kTaps = 8;  // along the line; each averages about two texels

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
