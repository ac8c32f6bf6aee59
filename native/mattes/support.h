// SPDX-License-Identifier: Apache-2.0
// Multi-view support of masks: along the ray of a pixel, the place that the masks of the other cameras contradict
// least. Pixels without contradiction lie in the projected visual hull of the others. Works on a grid of pixels.
// Method: algorithms/mattes.md.
#pragma once

#include <glm/glm.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "capture/undistort.h"

namespace fourdvt::mattes {

// Support of one camera's pixels by the others, as filmed; on a grid of every stepOf()-th pixel.
struct Support {
  cv::Mat missed;    // CV_16S: number of the others that see the best place along the ray outside their masks; -1 where
                     // too few of them see the ray, -2 where not searched: far from every mask
  cv::Mat height_m;  // CV_32F: highest place above the floor inside the masks of all others; -infinity without one
};

class SupportFinder {
 public:
  // Copies the cameras. `ground_y_m`: height of the floor.
  SupportFinder(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m);
  ~SupportFinder();

  // `masks`: CV_8U, one per camera, as filmed; empty ones are ignored. `slack_pixels`: tolerance for masks that are too
  // small and for calibration errors. `also`: further regions to search, one per camera, e.g. earlier masks; may be
  // empty.
  std::vector<Support> find(const std::vector<cv::Mat>& masks, double slack_pixels,
                            const std::vector<cv::Mat>& also = {}) const;

  // Patches that lie on the floor as a shadow does: the floor along the ray is in the masks of all cameras that see it,
  // and darker than the plates, by about the same ratio in at least two others and half of them. `darkness`: CV_8U, one
  // per camera, as filmed: 128 × picture / plate, at most 255, 0 where unknown; empty for a camera without plates.
  // Returns CV_8U, 255 or 0, one per camera, on the grid.
  std::vector<cv::Mat> shadows(const std::vector<cv::Mat>& masks, const std::vector<cv::Mat>& darkness,
                               double slack_pixels) const;

  // Initial region of the performer, pixels whose rays pass a place that all cameras see: CV_8U, 255 or 0, one per
  // camera, on the grid.
  std::vector<cv::Mat> seenByAll() const;

  struct Explained {
    std::vector<double> share;                 // [camera] share of its mask that lies in the hull of all others
    std::vector<std::vector<double>> without;  // [camera][other] the same without the mask of `other`; NaN on the
                                               // diagonal
  };
  // Judges every stepOf()-th pixel or fewer. NaN where a camera's mask is empty or cannot be judged.
  Explained explain(const std::vector<cv::Mat>& masks, double slack_pixels) const;

  // Grid values at full size; each pixel has its cell's value.
  cv::Mat fullSize(const cv::Mat& grid, size_t camera) const;
  int stepOf(size_t camera) const;  // pixels
  // Footprint of a pixel where the cameras look, metres; mean over all cameras.
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

// Names the camera whose silhouette, calibration or time does not fit a common visual hull and by how much, in one line
// without a full stop. nullopt if a common volume explains the silhouettes, or with fewer than three cameras that see
// something. `masks`: as filmed.
std::optional<std::string> disagreement(const std::vector<capture::CaptureCamera>& cameras,
                                        const std::vector<cv::Mat>& masks);

}  // namespace fourdvt::mattes
