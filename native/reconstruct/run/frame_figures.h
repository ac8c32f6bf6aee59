// SPDX-License-Identifier: Apache-2.0
// What is known of one reconstructed frame, kept beside its mesh until the report is written.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fourdvt::reconstruct {

inline constexpr double kMoved_m = 0.003;

struct FrameFigures {
  uint32_t vertices = 0, triangles = 0;
  uint32_t triangles_made = 0;  // before simplification
  // Lengths that the surface was made with, the same for all frames of a sequence: see SequenceScale.
  double footprint_m = 0, person_metre_m = 0, voxel_m = 0;
  uint32_t parts_left_out = 0;     // components that were left out
  std::string fallback;            // why the polyhedral hull was not taken; empty: it was, or was not asked for
  double volume_m3 = 0;            // of the surface
  double seen_m3 = 0;              // that more than half of the cameras see; 0: unknown
  std::vector<double> cover;       // per camera: share of the picture that the silhouette covers
  std::vector<double> overlap;     // per camera: intersection over union of mesh and silhouette; NaN: no silhouette
  std::vector<double> outline_px;  // per camera: median distance of the silhouette's outline from the mesh's; NaN: none
  // With stereo, per camera, else empty. Overlap as above; shares of the hull in the camera's picture.
  std::vector<double> hull_overlap;  // of the hull, before stereo
  std::vector<double> believed;      // its own depths there are believed: texture, and confirmed by other cameras
  std::vector<double> moved;  // the surface lies at least kMoved_m (of a person) deeper than the hull, or is gone
  double read_ms = 0, silhouettes_ms = 0, hull_ms = 0, stereo_ms = 0, fairing_ms = 0, check_ms = 0;
  double seconds() const { return (read_ms + silhouettes_ms + hull_ms + stereo_ms + fairing_ms + check_ms) / 1e3; }
};

// JSON; a list has null for NaN.
std::string figuresText(const FrameFigures& figures);

}  // namespace fourdvt::reconstruct
