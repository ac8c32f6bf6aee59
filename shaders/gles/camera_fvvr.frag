// SPDX-License-Identifier: Apache-2.0
// Free-viewpoint video rendering: LVDT Eq. 3-4 (corrected sign) at run time.
#include "camera_shade.glsl"

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return cosine * max(dot(to_camera, to_eye), 0.0); }
