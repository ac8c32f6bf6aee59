// SPDX-License-Identifier: Apache-2.0
// Each camera's picture on the surface in the view. Where a camera's weight is 0, the camera with the largest weight is
// shown instead (FT 4.2), which keeps flow from false matches; where all are 0, the fill colour.
#include "camera_unseen.glsl"
uniform sampler2D u_weights;  // the view's size, a channel per camera
layout(location = 0) out vec4 o_first;
#if CAMERAS > 1
layout(location = 1) out vec4 o_second;
#endif
#if CAMERAS > 2
layout(location = 2) out vec4 o_third;
#endif
#if CAMERAS > 3
layout(location = 3) out vec4 o_fourth;
#endif

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return cosine; }

void main() {
  vec4 weights = texelFetch(u_weights, ivec2(gl_FragCoord.xy), 0);
  int best = 0;
  for (int i = 1; i < CAMERAS; ++i)
    if (weights[i] > weights[best]) best = i;
  vec4 colors[CAMERAS];
  vec4 other = weights[best] > 0.0 ? pictureColor(projected(v_point, best).xy, best) :
               u_fills ? unseenColor(normalize(v_normal)) : vec4(0.0);
  for (int i = 0; i < CAMERAS; ++i)
    colors[i] = weights[i] > 0.0 ? pictureColor(projected(v_point, i).xy, i) : other;
  o_first = colors[0];
#if CAMERAS > 1
  o_second = colors[1];
#endif
#if CAMERAS > 2
  o_third = colors[2];
#endif
#if CAMERAS > 3
  o_fourth = colors[3];
#endif
}
