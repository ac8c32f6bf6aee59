// SPDX-License-Identifier: Apache-2.0
// Flow at the pictures' size, faded by confidence. EXPLAINS: also faded where it does not align the pictures.
in vec2 v_uv;
out vec2 o_flow;
uniform sampler2D u_flow, u_pictures;
uniform float u_gain;

#ifdef EXPLAINS
const float kStep = 4.0;           // pixels between 5 x 5 samples
const float kNoise = 1.0 / 255.0;  // luma
uniform float u_must_explain;      // share of the difference's variance (FlowOptions)
uniform float u_sure;              // displacement exempt from u_must_explain, pixels

// Returns the share of the displacement to keep, by its reduction of the variance of b - a round the pixel; 1 for long
// ones.
float explained(vec2 flow) {
  vec2 size = vec2(textureSize(u_pictures, 0)), sums = vec2(0.0), squares = vec2(0.0);
  for (int i = 0; i < 25; ++i) {
    vec2 at = gl_FragCoord.xy + kStep * vec2(i % 5 - 2, i / 5 - 2);
    vec2 still = texture(u_pictures, at / size).xy;
    vec2 difference = vec2(still.y, texture(u_pictures, (at + flow) / size).y) - still.x;
    sums += difference;
    squares += difference * difference;
  }
  vec2 variance = squares / 25.0 - sums * sums / 625.0;
  float share = (variance.x - variance.y) / (u_must_explain * (variance.x + kNoise * kNoise));
  return max(clamp(share, 0.0, 1.0), smoothstep(0.5 * u_sure, u_sure, length(flow)));
}
#else
float explained(vec2 flow) { return 1.0; }
#endif

void main() {
  vec2 flow = texture(u_flow, v_uv).xy * u_gain;
  float confidence = texelFetch(u_pictures, ivec2(gl_FragCoord.xy), 0).a;
  o_flow = confidence > 0.0 ? flow * confidence * explained(flow) : vec2(0.0);
}
