// SPDX-License-Identifier: Apache-2.0
// Variant of layered.frag with ranks weighted by their cameras' fields (M4D Eq. 1, 4, 5). Where all fields are small
// the plain weights take over smoothly, as M4D keeps the normal-weighted blend where all γ are small.
#include "layered_weights.glsl"
in vec4 v_fields[(LAYERS + 3) / 4];  // fields of one member, by rank
uniform int u_field_member;
uniform float u_field_share;         // share of the fields in that member's weights, 0..1

const float kWhole = 0.25;  // ratio of fields to plain weights from which the fields have their whole share

// Returns the weights of the ranks of drawn member m, normalised to sum 1.
void rankShares(int m, vec3 normal, vec3 to_eye, out float shares[LAYERS]) {
  float fields[LAYERS];
  float sum = 0.0, field_sum = 0.0;
  for (int rank = 0; rank < LAYERS; ++rank) {
    int i = m * LAYERS + rank;
    shares[rank] = rankWeight(m, rank, normal, to_eye);
    fields[rank] = shares[rank] > 0.0 ? v_masks[i / 4][i % 4] * v_fields[rank / 4][rank % 4] : 0.0;
    sum += shares[rank];
    field_sum += fields[rank];
  }
  float share = m == u_field_member ? u_field_share * smoothstep(0.0, kWhole, field_sum / max(sum, kMinSum)) : 0.0;
  float missing = max(kMinSum - sum, 0.0);
  shares[0] += missing;
  sum += missing;
  for (int rank = 0; rank < LAYERS; ++rank)
    shares[rank] = mix(shares[rank] / sum, fields[rank] / max(field_sum, kMinSum * kMinSum), share);
}

#include "layered_shade.glsl"
