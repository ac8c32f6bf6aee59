// SPDX-License-Identifier: Apache-2.0
// Visible share of seven sample points from one camera, in the red channel; one texel per face, in table order.
#include "bake_mesh.glsl"
#include "bake_camera.glsl"
uniform int first_row;   // first row of the viewport
uniform int face_count;
out vec4 share;

const float kPull = 0.06;  // pulls corners towards the centroid by this share

bool pointSeen(vec3 point_in_world, vec3 normal_in_cam) {
  vec3 point_in_cam = (cam_from_world * vec4(point_in_world, 1.0)).xyz;
  vec2 pixel = pixelOf(point_in_cam);
  float bias;
  return isSeen(point_in_cam, normal_in_cam, pixel, bias) &&
         textureLod(picture, pixel / size_near_far.xy, 0.0).a > 0.5;
}

void main() {
  int face = (int(gl_FragCoord.y) - first_row) * TABLE_WIDTH + int(gl_FragCoord.x);
  share = vec4(0.0);
  if (face >= face_count) return;
  vec3 p[3];
  for (int k = 0; k < 3; ++k) p[k] = positionOf(cornerOf(3 * face + k));
  vec3 area_normal = cross(p[1] - p[0], p[2] - p[0]);
  if (dot(area_normal, area_normal) == 0.0) return;
  vec3 normal = mat3(cam_from_world) * normalize(area_normal);
  vec3 centre = (p[0] + p[1] + p[2]) / 3.0;
  int seen = int(pointSeen(centre, normal));
  for (int k = 0; k < 3; ++k) {
    seen += int(pointSeen(mix(p[k], centre, kPull), normal));
    seen += int(pointSeen(mix(0.5 * (p[k] + p[(k + 1) % 3]), centre, kPull), normal));
  }
  share = vec4(float(seen) / 7.0, 0.0, 0.0, 1.0);
}
