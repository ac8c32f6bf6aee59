// SPDX-License-Identifier: Apache-2.0
// Seams, flips, penalties and energy of finished labels, added up frame by frame.
#pragma once

#include "bake/labels/labelling.h"

namespace fourdvt::bake {

class LabelMeter {
 public:
  LabelMeter(const LabelOptions& options, const FaceGraph& graph);
  // Frames in ascending order; labels [layer][face].
  void add(const FaceCosts& costs, const std::vector<uint8_t>& labels);
  LabelStatistics statistics() const;  // without `seconds`

 private:
  // Faces, edges or steps of one layer.
  struct Counts {
    uint64_t seams = 0, flips = 0;                // whose two labels differ
    uint64_t camera_seams = 0, camera_flips = 0;  // and both are cameras
    uint64_t seen_seams = 0, seen_flips = 0;      // and both faces are seen
    uint64_t filled = 0, filled_seen = 0;
    double penalty = 0;  // of filled_seen
  };
  void addLayer(const FaceCosts& costs, const uint8_t* layer, int l, const std::vector<uint8_t>& seen);
  double distance(const std::vector<uint8_t>& a, size_t f, const std::vector<uint8_t>& b, size_t g) const;

  LabelOptions options_;
  const FaceGraph& graph_;
  std::vector<uint8_t> previous_, previous_seen_;  // the frame before: labels, and 1 for a face that a camera sees
  std::vector<Counts> layers_;
  uint64_t seen_edges_ = 0, seen_steps_ = 0;
  uint32_t frames_ = 0;
  double energy_ = 0;
};

}  // namespace fourdvt::bake
