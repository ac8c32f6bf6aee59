// SPDX-License-Identifier: Apache-2.0
// Dense inverse search (Kroeger 2016), one patch per fragment: takes the best start among its own and its neighbours',
// then runs Gauss-Newton on the mean-normalised difference.
out vec2 o_flow;
uniform sampler2D u_slopes;  // luma of a, of b, slope of a
uniform sampler2D u_start;   // initial flow
uniform vec4 u_place;        // texture coordinates in u_start: step between patches, first patch
uniform float u_gain;        // scale of u_start
uniform int u_iterations;
const int kPatch = 8, kStride = 4;
const float kPixels = float(kPatch * kPatch);
const float kDamping = 512.0;  // keeps untextured patches at their start

vec2 start(vec2 neighbour) { return texture(u_start, (gl_FragCoord.xy + neighbour) * u_place.xy + u_place.zw).xy * u_gain; }

// Sum of squared differences after removal of their mean; pull: its gradient over flow.
float mismatch(vec2 flow, vec2 mean_slope, out vec2 pull) {
  ivec2 corner = kStride * ivec2(gl_FragCoord.xy);
  vec2 size = vec2(textureSize(u_slopes, 0)), sums = vec2(0.0);
  pull = vec2(0.0);
  for (int i = 0; i < kPatch * kPatch; ++i) {
    ivec2 at = corner + ivec2(i % kPatch, i / kPatch);
    vec4 a = texelFetch(u_slopes, at, 0);
    float difference = texture(u_slopes, (vec2(at) + 0.5 + flow) / size).y - a.x;
    sums += vec2(difference, difference * difference);
    pull += difference * a.zw;
  }
  pull -= sums.x * mean_slope;
  return sums.y - sums.x * sums.x / kPixels;
}

void main() {
  vec2 mean = vec2(0.0);
  vec3 tensor = vec3(0.0);
  for (int i = 0; i < kPatch * kPatch; ++i) {
    vec2 slope = texelFetch(u_slopes, kStride * ivec2(gl_FragCoord.xy) + ivec2(i % kPatch, i / kPatch), 0).zw;
    mean += slope / kPixels;
    tensor += slope.xyx * slope.xyy;
  }
  tensor += vec3(kDamping, kDamping, 0.0) - kPixels * mean.xyx * mean.xyy;
  vec2 pull, next_pull;
  vec2 best = start(vec2(0.0));
  float min_cost = mismatch(best, mean, pull);
  for (int i = 0; i < 4; ++i) {
    vec2 candidate = start(vec2(i < 2 ? 2 * i - 1 : 0, i < 2 ? 0 : 2 * i - 5));
    float cost = mismatch(candidate, mean, next_pull);
    if (cost < min_cost) min_cost = cost, best = candidate, pull = next_pull;
  }
  vec2 from = best;
  for (int i = 0; i < u_iterations; ++i) {
    vec2 next = best - vec2(tensor.y * pull.x - tensor.z * pull.y, tensor.x * pull.y - tensor.z * pull.x) /
                           (tensor.x * tensor.y - tensor.z * tensor.z);
    float cost = mismatch(next, mean, next_pull);
    if (cost >= min_cost || distance(next, from) > float(kPatch)) break;
    min_cost = cost, best = next, pull = next_pull;
  }
  o_flow = best;
}
