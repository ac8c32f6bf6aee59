// SPDX-License-Identifier: Apache-2.0
// Seams, flips, penalties and energy of finished labels, added up frame by frame.
#pragma once

#include "bake/labels/labelling.h"

namespace fourdvt::bake {

// The last entry repeats; 0 where there is none.
float weightOfSlot(const std::vector<float>& weights, int slot);

class LabelMeter {
 public:
  LabelMeter(const LabelOptions& options, const FaceGraph& graph);
  // Frames in ascending order; labels [layer][face].
  void add(const FaceCosts& costs, const std::vector<uint8_t>& labels);
  LabelStatistics statistics() const;  // without `seconds`

 private:
  double distance(const std::vector<uint8_t>& a, size_t f, const std::vector<uint8_t>& b, size_t g) const;

  LabelOptions options_;
  const FaceGraph& graph_;
  std::vector<uint8_t> previous_;
  std::vector<uint64_t> seams_, flips_, camera_seams_, camera_flips_, filled_, seen_;
  std::vector<double> penalties_;
  uint32_t frames_ = 0;
  double energy_ = 0;
};

}  // namespace fourdvt::bake
