// SPDX-License-Identifier: Apache-2.0
// How far a point of the picture lies from the outline of a silhouette. Does NOT look beyond a margin round it.
#pragma once

#include <vector>

#include "base/image.h"

namespace fourdvt::reconstruct {

// Signed distances to the outline (coverage 127.5), pixels, positive inside the performer. Kept for the silhouette's
// bounding rectangle with a margin; sampled bilinearly.
class SilhouetteDistance {
 public:
  // `coverage`: 1 channel. Exact to about a tenth of a pixel where the outline is straight.
  explicit SilhouetteDistance(const Image& coverage);
  // No pixel belongs to the performer, or all do: there is no outline.
  bool empty() const { return empty_; }
  bool full() const { return full_; }
  // In pixels of the camera's picture, centres at + 0.5. Beyond the margin no more than the true distance; outside the
  // picture kOutside: what is not seen is not carved.
  float at(double x, double y) const;
  static constexpr float kOutside = 1e6f;

 private:
  int width_ = 0, height_ = 0;                       // of the whole picture
  int left_ = 0, top_ = 0, columns_ = 0, rows_ = 0;  // the part that is kept
  std::vector<float> pixels_;
  bool empty_ = true, full_ = false;
};

}  // namespace fourdvt::reconstruct
