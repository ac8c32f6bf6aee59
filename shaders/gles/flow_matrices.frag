// SPDX-License-Identifier: Apache-2.0
// Farnebäck's normal equations per pixel, from a's expansion here and b's expansion displaced by the current flow.
layout(location = 0) out vec4 o_first;   // G11, G12, G22, h1; y before x
layout(location = 1) out vec2 o_second;  // h2
in vec2 v_uv;
uniform sampler2D u_a, u_b, u_mixed, u_flow;
uniform float u_gain;  // scale of the current flow, which may be of a coarser level

const float kScale = 1.0 / 16.0;  // keeps half floats in range
// OpenCV's weights near the border: 0.14 for two pixels, 0.4472 for three.
vec2 border(vec2 distance) { return mix(mix(vec2(0.14), vec2(0.4472), step(2.0, distance)), vec2(1.0), step(5.0, distance)); }

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec2 size = vec2(textureSize(u_a, 0));
  vec2 flow = texture(u_flow, v_uv).xy * u_gain;
  vec4 a = texelFetch(u_a, at, 0);
  float mixed = texelFetch(u_mixed, at, 0).x;
  vec2 to = vec2(at) + flow;
  vec2 uv = (to + 0.5) / size;
  bool known = all(greaterThanEqual(to, vec2(0.0))) && all(lessThan(to, size - 1.0));
  vec4 b = known ? texture(u_b, uv) : vec4(0.0, 0.0, a.zw);
  float r6 = 0.25 * (mixed + (known ? texture(u_mixed, uv).y : mixed));
  vec2 r45 = 0.5 * (a.zw + b.zw);
  vec2 r23 = 0.5 * (a.xy - b.xy) + r45 * flow.yx + r6 * flow;
  vec2 edges = border(vec2(at)) * border(size - 1.0 - vec2(at));
  float edge = edges.x * edges.y;
  r6 *= edge;
  r45 *= edge;
  r23 *= edge;
  vec4 first = vec4(r45.x * r45.x + r6 * r6, (r45.x + r45.y) * r6, r45.y * r45.y + r6 * r6, r45.x * r23.x + r6 * r23.y);
  o_first = clamp(first * kScale, -6e4, 6e4);
  o_second = vec2(clamp((r6 * r23.x + r45.y * r23.y) * kScale, -6e4, 6e4), 0.0);
}
