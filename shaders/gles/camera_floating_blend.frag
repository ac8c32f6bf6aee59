// SPDX-License-Identifier: Apache-2.0
// Blends the camera pictures of a view by their weights (FT Eq. 1). WARPED: displaces each first (FT Eq. 5). Mean form:
// the mean at p resembles picture i at p + u_flow_i(p). PAIRS: picture i at p resembles the mean at p + u_flow_i(p), so
// the displacement is inverted by one fixed-point step. Displacements are in pixels of the weights, which have the
// view's size; pictures, flows and target may be smaller.
uniform sampler2D u_weights;
uniform sampler2D u_picture_0, u_picture_1, u_picture_2, u_picture_3;
uniform vec2 u_size;  // target size
out vec4 o_color;

vec2 here() { return gl_FragCoord.xy / u_size; }

#ifdef WARPED
uniform sampler2D u_flow_0, u_flow_1, u_flow_2, u_flow_3;

vec2 displacement(sampler2D flow, vec2 size) {
  vec2 first = texture(flow, here()).xy / size;
#ifdef PAIRS
  return -texture(flow, here() - first).xy / size;
#else
  return first;
#endif
}

vec4 shown(sampler2D picture, sampler2D flow) {
  vec4 warped = texture(picture, here() + displacement(flow, vec2(textureSize(u_weights, 0))));
  return warped.a > 0.99 ? warped : texture(picture, here());
}
#define SHOWN(picture, flow) shown(picture, flow)
#else
#define SHOWN(picture, flow) texture(picture, here())
#endif

void main() {
  vec4 weights = texture(u_weights, here());
  float sum = dot(weights, vec4(1.0));
  if (sum <= 0.0) {
    o_color = texture(u_picture_0, here());
    return;
  }
  weights /= sum;
  o_color = weights[0] * SHOWN(u_picture_0, u_flow_0);
#if CAMERAS > 1
  o_color += weights[1] * SHOWN(u_picture_1, u_flow_1);
#endif
#if CAMERAS > 2
  o_color += weights[2] * SHOWN(u_picture_2, u_flow_2);
#endif
#if CAMERAS > 3
  o_color += weights[3] * SHOWN(u_picture_3, u_flow_3);
#endif
}
