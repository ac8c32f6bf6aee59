// SPDX-License-Identifier: Apache-2.0
// Adds a flow field, weighted by one camera's share of the pixel, to the partial sum (FT Eq. 6).
uniform sampler2D u_before;   // same size as the target
uniform sampler2D u_flow;     // displacements in its own pixels; at most the weights' size
uniform sampler2D u_weights;
uniform int u_camera;   // camera that gives the weight; negative: weight 1
uniform float u_keeps;  // factor of the partial sum: 0 or 1
uniform vec2 u_scale;   // pixels of the weights per target pixel
uniform float u_most;   // displacement with full weight, heights of the picture; 0 at twice this
const float kMinMost = 4.0;  // minimum of u_most, pixels
out vec2 o_flow;

void main() {
  vec2 size = vec2(textureSize(u_weights, 0)), at = gl_FragCoord.xy * u_scale;
  vec4 weights = texture(u_weights, at / size);
  float sum = dot(weights, vec4(1.0));
  float share = u_camera < 0 ? 1.0 : sum > 0.0 ? weights[u_camera] / sum : 0.0;
  vec2 flow = size / vec2(textureSize(u_flow, 0)) * texture(u_flow, at / size).xy;
  float most = max(u_most * size.y, kMinMost);
  share *= 1.0 - smoothstep(most, 2.0 * most, length(flow));
  vec2 before = u_keeps > 0.0 ? texelFetch(u_before, ivec2(gl_FragCoord.xy), 0).xy : vec2(0.0);
  o_flow = before + share * flow;
}
