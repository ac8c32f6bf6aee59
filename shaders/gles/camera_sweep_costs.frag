// SPDX-License-Identifier: Apache-2.0
// Photo-consistency cost of the cameras at four points on each pixel's ray: the root of their weighted standard
// deviation, which limits the influence of highlights and occlusions. The same cameras, those that see the surface
// there, are used at all points. 0 at all points: fewer than two cameras.
#include "camera_blend.glsl"
#include "camera_sweep.glsl"
uniform vec3 u_eye;
uniform vec4 u_offsets;       // points' offsets, metres behind the surface
out vec4 o_costs;

const float kMaxDeviation = 0.35;

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return cosine * max(dot(to_camera, to_eye), 0.0); }

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  o_costs = vec4(0.0);
  if (!isSurface(here)) return;
  vec4 h = unprojected(here);
  vec3 point = h.xyz / h.w, ray = normalize(point - u_eye);
  vec3 normal = normalize(2.0 * texelFetch(u_normals, here, 0).xyz - 1.0);
  vec4 offsets = u_offsets;
  vec3 means[4];
  vec4 squares = vec4(0.0);
  for (int k = 0; k < 4; ++k) means[k] = vec3(0.0);
  float sum = 0.0;
  int voters = 0;
  for (int i = 0; i < CAMERAS; ++i) {
    vec3 to_camera = normalize(u_centres[i].xyz - point);
    float cosine = dot(normal, to_camera);
    if (cosine <= u_least_cosine) continue;
    float weight = cameraWeight(to_camera, cosine, -ray);
    if (weight <= 0.0) continue;
    vec3 at = projected(point, i);
    if (at.z <= 0.0 || isHidden(at, cosine, i)) continue;
    vec3 from = (u_pixel_from_character[i] * vec4(point, 1.0)).xyz, along = mat3(u_pixel_from_character[i]) * ray;
    for (int k = 0; k < 4; ++k) {
      vec3 place = from + offsets[k] * along;
      vec3 color = pictureColor(place.xy / place.z, i).rgb;
      means[k] += weight * color;
      squares[k] += weight * dot(color, color);
    }
    sum += weight;
    ++voters;
  }
  if (voters < 2) return;
  vec4 costs;  // WebGL forbids dynamic indices for outputs
  for (int k = 0; k < 4; ++k) {
    vec3 mean = means[k] / sum;
    costs[k] = sqrt(sqrt(max(squares[k] / sum - dot(mean, mean), 0.0)) / kMaxDeviation);
  }
  o_costs = costs;
}
