// SPDX-License-Identifier: Apache-2.0
// Montage4D: blends the slots' cameras by their fields, interpolated over the triangle (M4D Eq. 1). A camera that does
// not see the fragment is excluded whatever its field; if all are excluded, normal weights (M4D Eq. 2) are used.
#include "camera_unseen.glsl"
#include "camera_slots.glsl"
centroid in vec4 v_low;   // fields
centroid in vec4 v_high;
uniform float u_exponent;
out vec4 o_color;

const float kMinShare = 0.03;  // minimum share of a camera to be sampled

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return pow(cosine, u_exponent); }

void main() {
  vec3 normal = normalize(v_normal), color = vec3(0.0);
  float sum = 0.0, least = kMinShare * (dot(v_low, vec4(1.0)) + dot(v_high, vec4(1.0)));
  for (int i = 0; i < CAMERAS; ++i) {
    float share = slotOf(v_low, v_high, i);
    if (share <= least) continue;
    vec3 at = projected(v_point, i);
    if (at.z <= 0.0 || isHidden(at, dot(normal, normalize(u_centres[i].xyz - v_point)), i)) continue;
    vec4 texel = pictureColor(at.xy, i);
    color += share * texel.a * texel.rgb;
    sum += share * texel.a;
  }
  o_color = sum > kMinSum ? vec4(color / sum, 1.0) : blendCameras(v_point, normal, normal);
  if (o_color.a == 0.0 && u_fills) o_color = unseenColor(normal);
}
