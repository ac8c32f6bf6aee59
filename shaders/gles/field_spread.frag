// SPDX-License-Identifier: Apache-2.0
// One Jacobi step of the distances from the seams over the surface, a texel per vertex. A vertex is reached along its
// edges, and across each of its faces from the two other vertices, in two ways: the distance grows evenly over the
// face, as from a straight seam, or from a point source placed in the unfolded face by the two distances (M4D 4.4, Fig.
// 5). The latter is a window of SSKGH05 (Vitaly Surazhsky, Tatiana Surazhsky, Danil Kirsanov, Steven J. Gortler, Hugues
// Hoppe: Fast Exact and Approximate Geodesics on Meshes. ACM Transactions on Graphics 24(3) (SIGGRAPH), 2005). It is
// too small for straight seams, the former too large for points; the mean is within 5 % of the clamp for both.
#include "field_neighbours.glsl"
uniform sampler2D u_before_low;
uniform sampler2D u_before_high;
uniform float u_per_metre;   // 1 / clamp
uniform float u_least_side;  // minimum mean side of a face, in units of the clamp; smaller ones count as this large
layout(location = 0) out vec4 o_low;
layout(location = 1) out vec4 o_high;

const vec4 kNone = vec4(4.0);

// Distances at a third corner `at`, in the frame of the first with x along the base, from distances a and b at two
// corners that are `base` apart. The shortest paths must cross the base; the conditions are multiplied out to avoid
// divisions.
vec4 across(vec4 a, vec4 b, float base, vec2 at) {
  float per_base = 1.0 / base;
  vec4 growth = (b - a) * per_base, steep = 1.0 - growth * growth;
  vec4 rise = sqrt(max(steep, 0.0)), along = at.x * rise - at.y * growth;  // crossing point on the base, times rise
  vec4 even = step(1e-6, steep) * step(0.0, along) * step(along, base * rise);
  vec4 straight = mix(kNone, a + growth * at.x + rise * at.y, even);
  vec4 source_x = 0.5 * (base - growth * (a + b)), square = a * a - source_x * source_x;
  vec4 source_y = sqrt(max(square, 0.0)), x = at.x - source_x, y = at.y + source_y;
  along = source_x * y + x * source_y;  // crossing point, times y
  vec4 meets = step(0.0, square) * step(0.0, along) * step(along, base * y);
  vec4 round = mix(kNone, sqrt(x * x + y * y), meets);
  return mix(min(straight, round), 0.5 * (straight + round), even * meets);
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  o_low = texelFetch(u_before_low, here, 0);
  o_high = texelFetch(u_before_high, here, 0);
  int vertex = vertexHere();
  if (vertex >= u_vertex_count) return;
  vec3 point = fetchPosition(vertex);
  int end = neighbourTexel(vertex + 1);
  for (int i = neighbourTexel(vertex); i < end; i += 2) {
    int first = neighbourTexel(i), second = neighbourTexel(i + 1);
    ivec2 at_first = tableTexel(first), at_second = tableTexel(second);
    vec4 low_a = texelFetch(u_before_low, at_first, 0), low_b = texelFetch(u_before_low, at_second, 0);
    vec4 high_a = texelFetch(u_before_high, at_first, 0), high_b = texelFetch(u_before_high, at_second, 0);
    vec4 least = min(min(low_a, low_b), min(high_a, high_b));
    if (min(min(least.x, least.y), min(least.z, least.w)) >= 1.0) continue;
    vec3 a = fetchPosition(first), to_b = fetchPosition(second) - a, to_point = point - a;
    float base = length(to_b), side = length(to_point), other = length(to_point - to_b);
    float scale = max(u_per_metre, 3.0 * u_least_side / max(base + side + other, 1e-6));
    o_low = min(o_low, min(low_a + side * scale, low_b + other * scale));
    o_high = min(o_high, min(high_a + side * scale, high_b + other * scale));
    if (base < 1e-5) continue;
    float x = dot(to_point, to_b) / base;
    vec2 at = vec2(x, sqrt(max(side * side - x * x, 0.0))) * scale;
    o_low = min(o_low, across(low_a, low_b, base * scale, at));
    o_high = min(o_high, across(high_a, high_b, base * scale, at));
  }
}
