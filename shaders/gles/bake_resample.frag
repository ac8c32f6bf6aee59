// SPDX-License-Identifier: Apache-2.0
// Resamples one texel of a layer from one camera's picture: straight colour with alpha `mark`, or 0 where the camera
// does not see the point, another part of the body occludes it within contour_pixels, or the matte is background.
#include "bake_camera.glsl"
in vec3 v_point_in_world;
flat in vec3 v_normal_in_world;
uniform mat4 colour_map;        // affine, on straight colour
uniform float mark;
uniform float contour_pixels;
uniform float contour_step;     // depth step of a contour, metres
uniform float matte_threshold;
uniform float matte_pixels;     // distance to background
out vec4 texel;

const float kDiagonal = 0.70710678;
const vec2 kRing[8] = vec2[8](vec2(1, 0), vec2(kDiagonal, kDiagonal), vec2(0, 1), vec2(-kDiagonal, kDiagonal),
                              vec2(-1, 0), vec2(-kDiagonal, -kDiagonal), vec2(0, -1), vec2(kDiagonal, -kDiagonal));

// Returns true near the contour of an occluder. Depth is dilated: nearest surface on a ring round the pixel, and on one
// of half its radius if the ring is wide.
bool isNearContour(vec2 pixel, float depth, float slope_per_pixel) {
  float nearest = mappedDepth(pixel);
  for (int k = 0; k < 8; ++k) {
    nearest = min(nearest, mappedDepth(pixel + contour_pixels * kRing[k]));
    if (contour_pixels > 2.0) nearest = min(nearest, mappedDepth(pixel + 0.5 * contour_pixels * kRing[k]));
  }
  return nearest < depth - contour_step - max(contour_pixels, 1.0) * slope_per_pixel;
}

bool isNearBackground(vec2 pixel) {
  if (matte_pixels <= 0.0) return false;
  float min_alpha = 1.0;
  for (int k = 0; k < 8; ++k)
    min_alpha = min(min_alpha, textureLod(picture, (pixel + matte_pixels * kRing[k]) / size_near_far.xy, 0.0).a);
  return min_alpha < matte_threshold;
}

#ifdef FILTER_BICUBIC
#include "sharp_filter.glsl"
vec4 filterTap(ivec2 pixel, int i) { return texelFetch(picture, pixel, 0); }

// Returns the pixels spanned by one texel.
float texelPixels(vec2 pixel) {
  vec2 dx = dFdx(pixel), dy = dFdy(pixel);
  return sqrt(max(dot(dx, dx), dot(dy, dy)));
}
#endif

void main() {
  vec3 point_in_cam = (cam_from_world * vec4(v_point_in_world, 1.0)).xyz;
  vec2 pixel = pixelOf(point_in_cam);
  vec4 premultiplied = texture(picture, pixel / size_near_far.xy);
  float coverage = premultiplied.a;
#ifdef FILTER_BICUBIC
  if (texelPixels(pixel) < 2.0) premultiplied = sampleSharp(pixel, ivec2(size_near_far.xy), matte_threshold, premultiplied, 0);
#endif
  float bias;
  bool seen = isSeen(point_in_cam, mat3(cam_from_world) * v_normal_in_world, pixel, bias) &&
              !isNearContour(pixel, point_in_cam.z, bias - depth_bias) && coverage > matte_threshold && !isNearBackground(pixel);
  vec3 colour = premultiplied.rgb / max(premultiplied.a, 1.0 / 255.0);
  texel = seen ? vec4(clamp((colour_map * vec4(colour, 1.0)).rgb, 0.0, 1.0), mark) : vec4(0.0);
}
