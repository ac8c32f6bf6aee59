// SPDX-License-Identifier: Apache-2.0
// Silhouettes: what one camera shows about where the performer can be, and how far a point of its picture lies from the
// outline.
#pragma once

#include <vector>

#include "base/camera.h"
#include "base/image.h"

namespace fourdvt::silhouette {

// The picture elements in which a camera sees the performer. What lies outside the picture is unknown, not empty.
struct Silhouette {
  PinholeCamera camera;
  Image coverage;  // 1 channel, the camera's size: 0 background, 255 performer, the outline at 127.5 between centres
};

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

}  // namespace fourdvt::silhouette
