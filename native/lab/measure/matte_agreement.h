// SPDX-License-Identifier: Apache-2.0
// Agreement of mattes with true mattes, over any number of pictures of one size. Pixels of at least half coverage are
// inside.
#pragma once

#include "base/image.h"

namespace fourdvt::measure {

class MatteAgreement {
 public:
  static constexpr double kBand_pixels = 2;  // on either side of the true matte's edge

  // Both of one size; the last channel of each is the matte.
  void add(const Image& picture, const Image& truth);
  void add(const MatteAgreement& other);

  size_t pictures() const { return pictures_; }
  // Intersection over union of all pictures' pixels; 1 if both are empty everywhere. Outside the band: only pixels
  // whose centre is farther than kBand_pixels from the truth's edge.
  double iou() const { return ratio(all_); }
  double iouOutsideBand() const { return ratio(far_); }
  // Mean symmetric distance, pixels, between the boundary pixels of the matte and of the truth; NaN if no picture has
  // both.
  double edgeDistance() const;

 private:
  struct Counts {
    double both = 0, either = 0;
  };
  static double ratio(const Counts& c) { return c.either > 0 ? c.both / c.either : 1; }

  size_t pictures_ = 0;
  Counts all_, far_;
  double distance_ = 0, edge_pixels_ = 0;
};

}  // namespace fourdvt::measure
