// SPDX-License-Identifier: Apache-2.0
// Baseline of Montage4D (M4D Eq. 2): normal weights of the cameras that see the fragment, outside dilated depth
// discontinuities and not outvoted at its corners; without any such camera, both conditions are dropped.
#include "camera_unseen.glsl"
#include "camera_occluder.glsl"
#include "camera_slots.glsl"
centroid in vec4 v_low;   // votes
centroid in vec4 v_high;
uniform float u_exponent;
out vec4 o_color;

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return pow(cosine, u_exponent); }

void main() {
  vec3 normal = normalize(v_normal), color = vec3(0.0);
  float sum = 0.0;
  for (int i = 0; i < CAMERAS; ++i) {
    float cosine = dot(normal, normalize(u_centres[i].xyz - v_point));
    if (cosine <= u_least_cosine || slotOf(v_low, v_high, i) < 0.5) continue;
    vec3 at = projected(v_point, i);
    if (at.z <= 0.0 || isHidden(at, cosine, i) || isNearOccluder(at, cosine, i, u_discontinuity)) continue;
    vec4 texel = pictureColor(at.xy, i);
    float weight = pow(cosine, u_exponent) * texel.a;
    color += weight * texel.rgb;
    sum += weight;
  }
  o_color = sum > kMinSum ? vec4(color / sum, 1.0) : blendCameras(v_point, normal, normal);
  if (o_color.a == 0.0 && u_fills) o_color = unseenColor(normal);
}
