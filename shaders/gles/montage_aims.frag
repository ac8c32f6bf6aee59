// SPDX-License-Identifier: Apache-2.0
// Aims of the fields, a texel per vertex: V γ (n·v_i)^a (v·v_i)^b for each slot, that is M4D Eq. 4 with the surface's
// angle of LVDT Eq. 3. The global visibility g is omitted, since the bake already selects the cameras of a face.
#include "montage_slots.glsl"
uniform sampler2D u_distances_low;  // γ
uniform sampler2D u_distances_high;
uniform sampler2D u_positions_normals;
uniform vec4 u_slot_centres[8];     // camera centres of the slots, character's frame
uniform vec3 u_eye;
uniform vec2 u_powers;              // exponents: surface and ray, view and ray
layout(location = 0) out vec4 o_low;
layout(location = 1) out vec4 o_high;

vec3 g_point, g_normal, g_to_eye;

float viewing(int slot) {
  vec3 direction = normalize(u_slot_centres[slot].xyz - g_point);
  return pow(max(dot(g_normal, direction), 1e-4), u_powers.x) * pow(max(dot(g_to_eye, direction), 1e-4), u_powers.y);
}

void main() {
  o_low = o_high = vec4(0.0);
  int vertex = vertexHere();
  if (vertex >= u_vertex_count) return;
  g_point = texelFetch(u_positions_normals, tableTexel(2 * vertex), 0).xyz;
  g_normal = texelFetch(u_positions_normals, tableTexel(2 * vertex + 1), 0).xyz;
  g_to_eye = normalize(u_eye - g_point);
  uint mask = maskAt(vertex);
  ivec2 here = ivec2(gl_FragCoord.xy);
  o_low = seen(mask, u_slot_cameras[0]) * texelFetch(u_distances_low, here, 0) *
          vec4(viewing(0), viewing(1), viewing(2), viewing(3));
  o_high = seen(mask, u_slot_cameras[1]) * texelFetch(u_distances_high, here, 0) *
           vec4(viewing(4), viewing(5), viewing(6), viewing(7));
}
