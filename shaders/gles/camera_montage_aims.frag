// SPDX-License-Identifier: Apache-2.0
// Target weights of each slot's camera for the view (M4D Eq. 4, times the cosine of surface normal and ray), normalised
// to sum 1; where Σγ < 1 the normal weights (M4D Eq. 2) complete them. 0 where no camera sees the vertex. A texel per
// vertex.
#include "character_vertex.glsl"
#include "camera_slots.glsl"
uniform int u_vertex_count;
uniform vec4 u_centres[CAMERAS];  // xyz character's frame
uniform vec3 u_eye;
uniform float u_exponent;         // exponents of M4D Eq. 2 and 4
uniform float u_view_exponent;
uniform vec4 u_chosen_low;        // 1 if the view chooses the slot's camera
uniform vec4 u_chosen_high;
uniform sampler2D u_seen_low;
uniform sampler2D u_seen_high;
uniform sampler2D u_distances_low;
uniform sampler2D u_distances_high;
uniform sampler2D u_counts_low;   // one texel: number of visible vertices
uniform sampler2D u_counts_high;
const float kMinCosine = 0.05;  // minimum cosine of surface normal and ray
layout(location = 0) out vec4 o_low;
layout(location = 1) out vec4 o_high;

void main() {
  o_low = o_high = vec4(0.0);
  int vertex = int(gl_FragCoord.y) * TABLE_WIDTH + int(gl_FragCoord.x);
  if (vertex >= u_vertex_count) return;
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 seen_low = step(0.5, texelFetch(u_seen_low, here, 0)) * u_chosen_low,
       seen_high = step(0.5, texelFetch(u_seen_high, here, 0)) * u_chosen_high;
  vec4 gamma_low = texelFetch(u_distances_low, here, 0) * seen_low,
       gamma_high = texelFetch(u_distances_high, here, 0) * seen_high;
  vec4 global_low = texelFetch(u_counts_low, ivec2(0), 0), global_high = texelFetch(u_counts_high, ivec2(0), 0);
  vec3 point = fetchPosition(vertex), normal = normalize(fetchNormal(vertex)), to_eye = normalize(u_eye - point);
  vec4 plain_low = vec4(0.0), plain_high = vec4(0.0);
  for (int i = 0; i < CAMERAS; ++i) {
    vec3 ray = normalize(u_centres[i].xyz - point);
    float seen = slotOf(seen_low, seen_high, i);
    if (seen == 0.0) continue;
    setSlot(plain_low, plain_high, i, pow(max(dot(ray, normal), 1e-3), u_exponent));
    setSlot(o_low, o_high, i, slotOf(gamma_low, gamma_high, i) * slotOf(global_low, global_high, i) *
                                  pow(max(dot(ray, to_eye), 0.0), u_view_exponent) * max(dot(ray, normal), kMinCosine));
  }
  const vec4 one = vec4(1.0);
  float sum = dot(o_low, one) + dot(o_high, one), plain = dot(plain_low, one) + dot(plain_high, one);
  if (plain <= 0.0) return;
  float share = sum > 1e-7 ? min(dot(gamma_low, one) + dot(gamma_high, one), 1.0) : 0.0;
  o_low = share * o_low / max(sum, 1e-7) + (1.0 - share) * plain_low / plain;
  o_high = share * o_high / max(sum, 1e-7) + (1.0 - share) * plain_high / plain;
}
