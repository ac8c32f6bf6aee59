// SPDX-License-Identifier: Apache-2.0
// Silhouettes of the performer in camera pictures, and signed distances to their outlines.
#pragma once

#include <vector>

#include "base/camera.h"
#include "base/image.h"

namespace fourdvt::silhouette {

// Foreground mask of a camera's picture. Space that projects outside the picture is unknown, not empty.
struct Silhouette {
  PinholeCamera camera;
  Image coverage;  // 1 channel, camera size: 0 background, 255 performer, the outline at 127.5 between centres
};

// Signed distances to the outline (coverage 127.5), pixels, positive inside the performer. Stored for the silhouette's
// bounding rectangle plus a margin; sampled bilinearly.
class SilhouetteDistance {
 public:
  // `coverage`: 1 channel. Accurate to about 0.1 pixels along straight outlines.
  explicit SilhouetteDistance(const Image& coverage);
  // True if there is no outline: all pixels are background, or all are performer.
  bool empty() const { return empty_; }
  bool full() const { return full_; }
  // Signed distance at a position in the picture, pixels, centres at + 0.5. Beyond the margin: a lower bound of the
  // distance. Outside the picture: kOutside, so that unseen space is not carved.
  float at(double x, double y) const;
  static constexpr float kOutside = 1e6f;

 private:
  int width_ = 0, height_ = 0;                       // whole picture
  int left_ = 0, top_ = 0, columns_ = 0, rows_ = 0;  // stored part
  std::vector<float> pixels_;
  bool empty_ = true, full_ = false;
};

}  // namespace fourdvt::silhouette
