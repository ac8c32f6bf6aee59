// SPDX-License-Identifier: Apache-2.0
// Layered view-dependent texture: LVDT Eq. 3-4 with the corrected sign, per-fragment rays and seam feathering, for each
// drawn member; the members are blended by their weights. Marco Volino, Adrian Hilton: Layered View-Dependent Texture
// Maps. European Conference on Visual Media Production (CVMP), 2013. Blends encoded values, as the paper does.
#include "layered_weights.glsl"

// Returns the weights of the ranks of drawn member m, normalised to sum 1.
void rankShares(int m, vec3 normal, vec3 to_eye, out float shares[LAYERS]) {
  float sum = 0.0;
  for (int rank = 0; rank < LAYERS; ++rank) {
    shares[rank] = rankWeight(m, rank, normal, to_eye);
    sum += shares[rank];
  }
  float missing = max(kMinSum - sum, 0.0);
  shares[0] += missing;
  sum += missing;
  for (int rank = 0; rank < LAYERS; ++rank) shares[rank] /= sum;
}

#include "layered_shade.glsl"
