// SPDX-License-Identifier: Apache-2.0
// Inspection view of Montage4D, a colour per camera (M4D Fig. 3, 7): the fields, or (SEAMS) the distance to the
// cameras' seams.
#include "camera_slots.glsl"
centroid in vec3 v_point;
centroid in vec3 v_normal;
centroid in vec4 v_low;        // fields, or distances
centroid in vec4 v_high;
uniform vec3 u_eye;
uniform vec4 u_slot_colors[8];  // alpha 0: slot hidden
out vec4 o_color;

void main() {
  float light = 0.4 + 0.6 * abs(dot(normalize(v_normal), normalize(u_eye - v_point)));
  vec3 color = vec3(0.0);
  float sum = 0.0;
  for (int i = 0; i < 8; ++i) {
    float value = slotOf(v_low, v_high, i);
#ifdef SEAMS
    value = 1.0 - value;
    value *= value;
#endif
    color += u_slot_colors[i].a * value * u_slot_colors[i].rgb;
    sum += u_slot_colors[i].a * value;
  }
#ifdef SEAMS
  color += max(1.0 - sum, 0.0) * vec3(0.8);
  sum = max(sum, 1.0);
#endif
  o_color = vec4(light * color / max(sum, 1e-3), 1.0);
}
