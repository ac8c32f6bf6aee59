// SPDX-License-Identifier: Apache-2.0
// Occlusion and weight of up to four cameras per pixel of a view. The weight is by angle, times the cosine of surface
// normal and camera ray. (FT uses the angle alone; see algorithms/floating.md.)
#include "camera_blend.glsl"
centroid in vec3 v_point;  // character's frame, metres
centroid in vec3 v_normal;
uniform vec3 u_eye;
uniform vec4 u_next;       // xyz centre of the nearest unused camera, at which weights reach 0; w 0: none
layout(location = 0) out vec4 o_hidden;   // 1 on surface hidden from the camera; background 0
layout(location = 1) out vec4 o_weights;

const float kMinAngle = 0.01;  // radians
const float kMinShare = 0.01;  // minimum for cameras beyond the next one, used where no other camera sees the surface

// Camera weight of BBMGC01 by the angle between camera ray and view ray: 0 at `end`, unbounded at 0.
float angularWeight(float angle, float end) {
  return max(1.0 - angle / end, kMinShare) / max(angle, kMinAngle);
}

float angleBetween(vec3 a, vec3 b) { return acos(clamp(dot(a, b), -1.0, 1.0)); }

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return cosine; }

void main() {
  vec3 normal = normalize(v_normal), to_eye = normalize(u_eye - v_point);
  float end = u_next.w > 0.0 ? angleBetween(normalize(u_next.xyz - v_point), to_eye) : 3.15;
  vec4 are_hidden = vec4(0.0), weights = vec4(0.0);  // WebGL forbids dynamic indices for outputs
  for (int i = 0; i < CAMERAS; ++i) {
    vec3 ray = normalize(u_centres[i].xyz - v_point);
    float cosine = dot(normal, ray);
    vec3 at = projected(v_point, i);
    bool hidden = cosine <= u_least_cosine || at.z <= 0.0 || isHidden(at, cosine, i);
    are_hidden[i] = float(hidden);
    weights[i] = hidden ? 0.0 : cosine * angularWeight(angleBetween(ray, to_eye), end);
  }
  o_hidden = are_hidden;
  o_weights = weights;
}
