// SPDX-License-Identifier: Apache-2.0
// The cameras' pictures of a view, blended by their weights (FT Eq. 1); WARPED: each is displaced first (FT Eq. 5).
// Displacements are in pixels. Star form: the mean at p resembles picture i at p + u_flow_i(p). PAIRS: picture i at p
// resembles the mean at p + u_flow_i(p), so that it is asked for where that leads to the pixel.
uniform sampler2D u_weights;
uniform sampler2D u_picture_0, u_picture_1, u_picture_2, u_picture_3;
out vec4 o_color;

#ifdef WARPED
uniform sampler2D u_flow_0, u_flow_1, u_flow_2, u_flow_3;

vec2 displacement(sampler2D flow, vec2 size) {
  vec2 first = texelFetch(flow, ivec2(gl_FragCoord.xy), 0).xy;
#ifdef PAIRS
  return -texture(flow, (gl_FragCoord.xy - first) / size).xy;
#else
  return first;
#endif
}

vec4 shown(sampler2D picture, sampler2D flow) {
  vec2 size = vec2(textureSize(picture, 0)), at = gl_FragCoord.xy + displacement(flow, size);
  vec4 warped = texture(picture, at / size);
  return warped.a > 0.99 ? warped : texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
}
#define SHOWN(picture, flow) shown(picture, flow)
#else
#define SHOWN(picture, flow) texelFetch(picture, ivec2(gl_FragCoord.xy), 0)
#endif

void main() {
  vec4 weights = texelFetch(u_weights, ivec2(gl_FragCoord.xy), 0);
  float sum = dot(weights, vec4(1.0));
  if (sum <= 0.0) {
    o_color = texelFetch(u_picture_0, ivec2(gl_FragCoord.xy), 0);
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
