// SPDX-License-Identifier: Apache-2.0
// The study's views and scores: a ring of views through the cameras' directions and between them, and the papers'
// measures of one picture against a reference. Does NOT draw.
#pragma once

#include <deque>
#include <future>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "study/run/context.h"

namespace fourdvt::study {

// `count` azimuths, ascending in 0..360. Every 360/count degrees from the first camera, each camera's direction and
// each middle between two neighbours taking the place of the nearest one; with fewer views than that, a selection of
// camera and middle directions in turn.
std::vector<double> ringAzimuths_deg(std::vector<double> camera_azimuths_deg, int count);

struct RingView {
  PinholeCamera camera;  // name: "az022.5"
  uint32_t frame = 0;    // view i shows frame i·n/count
};
// Looking at the centre of the bounds. Elevation and distance follow those of the cameras over azimuth; the focal
// length is the cameras' mean, so that pixels are as dense as theirs; the picture is as large as the performer needs,
// and no larger than the cameras' pictures.
std::vector<RingView> ringViews(std::span<const PinholeCamera> cameras, const BoundingBox& bounds, uint32_t frame_count,
                                int count);

// Foreground: union of both silhouettes. Box: its bounding box. Full: whole picture. All over black.
struct PictureScore {
  double psnr_full_db = 0, psnr_box_db = 0, psnr_fg_db = 0, psnr_common_db = 0;
  double ssim_full = 0, ssim_box = 0, ssim_fg = 0;
};
// RGBA straight alpha, of one size. Infinite PSNR counts as 100 dB, so that means stay finite.
PictureScore scorePicture(const Image& reference, const Image& picture);

class MeanScores {
 public:
  void add(const PictureScore& score);
  size_t count() const { return count_; }
  PictureScore mean() const;
  // Rows ssim_fg, ssim_full, ssim_box, psnr_fg_db, psnr_full_db, psnr_box_db, psnr_common_db.
  void write(Rows& out, const std::string& table, const std::string& sequence, const std::string& method,
             const std::string& setting) const;

 private:
  PictureScore sum_;
  size_t count_ = 0;
};

// Scores on other threads while the caller draws on; at most a few pictures wait.
class ScoreLane {
 public:
  // `tag`: whatever the caller tells scores apart by, e.g. a camera's name; may be empty.
  void add(Image reference, Image picture, const std::string& tag = {});
  // Waits for all. Scores in order of add.
  std::vector<std::pair<std::string, PictureScore>> finish();
  MeanScores finishMean();

 private:
  static constexpr size_t kWaiting = 4;
  void collect(size_t keep);
  std::deque<std::pair<std::string, std::future<PictureScore>>> running_;
  std::vector<std::pair<std::string, PictureScore>> finished_;
};

}  // namespace fourdvt::study
