// SPDX-License-Identifier: Apache-2.0
// Limbs of a surface: its geodesic extremities, each with a curve through the middle of the limb. They lead a fit where
// a limb has moved farther than optical flow follows. Sources: Plagemann, Ganapathi, Koller, Thrun: Real-time
// Identification and Localization of Body Parts from Depth Images. ICRA 2010 (extremities); Lazarus, Verroust: Level
// Set Diagrams of Polyhedral Objects. ACM Solid Modeling 1999 (curves).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::track {

struct Limb {
  // Ring k holds the vertices at k to k + 1 steps from the tip along the surface, up to the trunk.
  struct Ring {
    glm::dvec3 middle{0};  // mean of its vertices by their area, metres
    double radius_m = 0;   // root mean square distance from the middle
    std::vector<uint32_t> vertices;
  };
  uint32_t tip = 0;  // vertex
  std::vector<Ring> rings;
};

struct LimbOptions {
  double step_m = 0.03;
  int count = 5;               // extremities at most
  double max_radius_m = 0.13;  // rings of the trunk are wider
  double min_length_m = 0.30;  // shorter ones are no limbs
};

// Limbs of the component round the middle of the surface, the longest first.
std::vector<Limb> limbsOf(const TriangleMesh& surface, const LimbOptions& options);

// Limbs of a coarser mesh of the same surface in the same pose: its vertices in the rings of the nearest places.
std::vector<Limb> limbsOn(const Positions& positions, const TriangleMesh& surface, std::span<const Limb> limbs);

// Sets the rings' middles and radii for vertices that have moved. Equal weights.
void follow(const Positions& positions, std::vector<Limb>& limbs);

// Limb of `from` and of `to` that are one and the same.
struct LimbPair {
  size_t from = 0, to = 0;
};
// Pairs limbs by the distance of their curves and by their thickness; limbs without counterpart stay alone.
std::vector<LimbPair> pairedLimbs(std::span<const Limb> from, std::span<const Limb> to);

}  // namespace fourdvt::track
