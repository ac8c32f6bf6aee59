// SPDX-License-Identifier: Apache-2.0
// Free-viewpoint video rendering with the options of FvvrOptions: FACING_EXPONENT and VIEW_EXPONENT, both 1 in LVDT
// Eq. 3-4, and SHARP. Pictures are layers of an array.
#ifdef SHARP
#define OWN_COLOR
#endif
#include "camera_shade.glsl"
#include "sharp_filter.glsl"

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) {
  return pow(cosine, FACING_EXPONENT) * pow(max(dot(to_camera, to_eye), 0.0), VIEW_EXPONENT);
}

vec4 filterTap(ivec2 pixel, int i) { return texelFetch(u_pictures, ivec3(pixel, int(u_pixel_spans[i].w)), 0); }

#ifdef SHARP
vec4 cameraColor(vec3 point, vec3 to_eye, vec3 at, int i) {
  vec4 plain = pictureColor(at.xy, i);
  if (plain.a == 0.0) return plain;
  vec4 texel = sampleSharp(at.xy, ivec2(u_sizes_near_far[i].xy), 0.5, plain, i);
  return vec4(texel.rgb / texel.a, 1.0);
}
#endif
