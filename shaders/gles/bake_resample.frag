// SPDX-License-Identifier: Apache-2.0
// One texel of a layer from one camera's picture: straight colour with alpha 1, or 0 where the camera does not see the
// point, another part of the body passes in front within a pixel and a half, or the matte says background.
#include "bake_camera.glsl"
in vec3 v_point_in_world;
flat in vec3 v_normal_in_world;
out vec4 texel;

const float kContourPixels = 1.5;
const float kContourStep = 0.02;  // metres of depth that make a contour

bool isNearContour(vec2 pixel, float depth_in_front) {
  float nearest = min(min(mappedDepth(pixel + vec2(kContourPixels, 0)), mappedDepth(pixel - vec2(kContourPixels, 0))),
                      min(mappedDepth(pixel + vec2(0, kContourPixels)), mappedDepth(pixel - vec2(0, kContourPixels))));
  return nearest < depth_in_front - kContourStep;
}

void main() {
  vec3 point_in_cam = (cam_from_world * vec4(v_point_in_world, 1.0)).xyz;
  vec2 pixel = pixelOf(point_in_cam);
  vec4 premultiplied = texture(picture, pixel / size_near_far.xy);
  float bias;
  bool seen = isSeen(point_in_cam, mat3(cam_from_world) * v_normal_in_world, pixel, bias) &&
              !isNearContour(pixel, point_in_cam.z - bias) && premultiplied.a > 0.5;
  texel = seen ? vec4(premultiplied.rgb / premultiplied.a, 1.0) : vec4(0.0);
}
