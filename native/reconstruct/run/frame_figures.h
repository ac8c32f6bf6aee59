// SPDX-License-Identifier: Apache-2.0
// Figures of one reconstructed frame, stored beside its mesh for the report.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fourdvt::reconstruct {

inline constexpr double kMoved_m = 0.003;

struct FrameFigures {
  uint32_t vertices = 0, triangles = 0;
  uint32_t triangles_made = 0;  // before simplification
  // Lengths of the sequence, see SequenceScale.
  double footprint_m = 0, person_metre_m = 0, voxel_m = 0;
  uint32_t parts_left_out = 0;     // removed components
  std::string fallback;            // reason for falling back from the polyhedral hull; empty: no fallback
  double volume_m3 = 0;            // surface volume
  double seen_m3 = 0;              // seen by more than half of the cameras; 0: unknown
  std::vector<double> cover;       // [camera] share of the picture covered by the silhouette
  std::vector<double> overlap;     // [camera] intersection over union of mesh and silhouette; NaN: no silhouette
  std::vector<double> outline_px;  // [camera] median distance of the silhouette's outline from the mesh's; NaN: none
  // [camera], only with stereo, else empty. Shares refer to the hull in the camera's picture.
  std::vector<double> hull_overlap;  // overlap of the hull before stereo
  std::vector<double> believed;      // share with valid depths: textured, and confirmed by other cameras
  std::vector<double>
      moved;  // share with a surface at least kMoved_m (normalised to a person) behind the hull, or without surface
  double read_ms = 0, silhouettes_ms = 0, hull_ms = 0, stereo_ms = 0, fairing_ms = 0, check_ms = 0;
  double seconds() const { return (read_ms + silhouettes_ms + hull_ms + stereo_ms + fairing_ms + check_ms) / 1e3; }
};

// Serialises as JSON; NaN in a list becomes null.
std::string figuresText(const FrameFigures& figures);

}  // namespace fourdvt::reconstruct
