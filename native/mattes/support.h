// SPDX-License-Identifier: Apache-2.0
// Evidence that cameras have for one another's masks: along the ray of a pixel, the place that the masks of the others
// contradict least. Where none contradicts it the pixel lies in the projected visual hull of the others. Works on a
// grid of pixels. Does NOT make masks. Method: algorithms/mattes.md.
#pragma once

#include <glm/glm.hpp>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "capture/capture.h"
#include "capture/undistort.h"

namespace fourdvt::mattes {

// One camera's view of the others, as filmed; on a grid of every stepOf()-th pixel.
struct Support {
  cv::Mat missed;    // CV_16S: how many of the others see the best place along the ray and have it outside their masks;
                     // -1 where not enough of them see the ray, -2 where nobody looked: far from every mask
  cv::Mat height_m;  // CV_32F: highest place above the floor that none of them misses; -infinity where there is none
};

class SupportFinder {
 public:
  // Copies the cameras. `ground_y_m`: of the floor.
  SupportFinder(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m);
  ~SupportFinder();

  // `masks`: CV_8U, one per camera, as filmed; one that is empty takes no part. `slack_pixels`: how far a mask may be
  // too small, and the calibration off. `also`: where else support is to be looked for, one per camera, e.g. earlier
  // masks; may be empty.
  std::vector<Support> find(const std::vector<cv::Mat>& masks, double slack_pixels,
                            const std::vector<cv::Mat>& also = {}) const;

  // Patches that lie on the floor as a shadow does: the floor along the ray is in the masks of all cameras that see it,
  // and darker than the plates, by about the same ratio in two others and half of them at least. `darkness`: CV_8U, one
  // per camera, as filmed: 128 × picture / plate, at most 255, 0 where it is not known; empty for a camera without
  // plates. CV_8U, 255 or 0, one per camera, on the grid.
  std::vector<cv::Mat> shadows(const std::vector<cv::Mat>& masks, const std::vector<cv::Mat>& darkness,
                               double slack_pixels) const;

  // First guess at the performer, pixels whose rays pass a place that all cameras see: CV_8U, 255
  // or 0, one per camera, on the grid.
  std::vector<cv::Mat> seenByAll() const;

  struct Explained {
    std::vector<double> share;                 // [camera] of its mask that lies in the hull of all others
    std::vector<std::vector<double>> without;  // [camera][other] the same if `other` had no mask; NaN on the diagonal
  };
  // NaN where a camera's mask is empty, or none of it can be judged. Judges every stepOf()-th pixel or fewer.
  Explained explain(const std::vector<cv::Mat>& masks, double slack_pixels) const;

  // A grid's values at full size, where a pixel has that of its cell.
  cv::Mat fullSize(const cv::Mat& grid, size_t camera) const;
  int stepOf(size_t camera) const;  // pixels
  // Metres that a pixel covers where the cameras look; the mean of all cameras.
  double footprint_m() const { return footprint_m_; }

 private:
  struct Rays;
  struct Search;
  cv::Mat asPinhole(size_t camera, const cv::Mat& filmed) const;
  bool shadowAt(size_t camera, int at, const std::vector<cv::Mat>& masks, const std::vector<cv::Mat>& darkness) const;
  std::vector<cv::Mat> pinholeMasks(const std::vector<cv::Mat>& masks, double slack_pixels) const;
  Search searchOf(size_t camera, const std::vector<cv::Mat>& masks) const;
  Support supportOf(size_t camera, const std::vector<cv::Mat>& masks, const std::vector<cv::Mat>& grown,
                    const cv::Mat& own) const;

  std::vector<Rays> rays_;
  double ground_y_m_, footprint_m_ = 0;
};

}  // namespace fourdvt::mattes
