// SPDX-License-Identifier: Apache-2.0
// Mean of the costs over a row or column of pixels on the same part of the surface.
#include "camera_sweep.glsl"
uniform highp sampler2DArray u_costs;
uniform int u_block;
uniform vec2 u_step;
uniform int u_radius;
out vec4 o_costs;

const float kSamePart = 0.03;  // depth difference within one part of a person, metres

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(u_normals, 0) - 1;
  o_costs = vec4(0.0);
  if (!isSurface(here)) return;
  float depth = surfaceDepth(here), sum = 0.0;
  for (int i = -u_radius; i <= u_radius; ++i) {
    ivec2 at = here + i * ivec2(u_step);
    if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last)) || !isSurface(at)) continue;
    float away = (surfaceDepth(at) - depth) / (u_length_scale * kSamePart), weight = exp(-away * away);
    o_costs += weight * texelFetch(u_costs, ivec3(at, u_block), 0);
    sum += weight;
  }
  o_costs /= max(sum, 1e-6);
}
