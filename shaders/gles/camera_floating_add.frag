// SPDX-License-Identifier: Apache-2.0
// Adds a flow field, weighted by one camera's share of the pixel, to the sum of those before it (FT Eq. 6).
uniform sampler2D u_before;   // of the target's size
uniform sampler2D u_flow;     // in its own pixels, of the weights' size or smaller
uniform sampler2D u_weights;
uniform int u_camera;   // whose share; negative: 1
uniform float u_keeps;  // of the sum before: 0 or 1
uniform vec2 u_scale;   // pixels of the weights per pixel that is drawn
uniform float u_most;   // of a displacement that counts in full, heights of the picture; at twice it, none does
const float kLeastMost = 4.0;  // pixels, of what u_most bounds
out vec2 o_flow;

void main() {
  vec2 size = vec2(textureSize(u_weights, 0)), at = gl_FragCoord.xy * u_scale;
  vec4 weights = texture(u_weights, at / size);
  float sum = dot(weights, vec4(1.0));
  float share = u_camera < 0 ? 1.0 : sum > 0.0 ? weights[u_camera] / sum : 0.0;
  vec2 flow = size / vec2(textureSize(u_flow, 0)) * texture(u_flow, at / size).xy;
  float most = max(u_most * size.y, kLeastMost);
  share *= 1.0 - smoothstep(most, 2.0 * most, length(flow));
  vec2 before = u_keeps > 0.0 ? texelFetch(u_before, ivec2(gl_FragCoord.xy), 0).xy : vec2(0.0);
  o_flow = before + share * flow;
}
