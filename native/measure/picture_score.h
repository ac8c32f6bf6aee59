// SPDX-License-Identifier: Apache-2.0
// Scores of a picture against a reference by the papers' metrics, their means, and their computation on other threads.
#pragma once

#include <deque>
#include <future>
#include <string>
#include <utility>
#include <vector>

#include "base/image.h"
#include "measure/metrics.h"

namespace fourdvt::measure {

// Foreground: union of both silhouettes; common: their intersection. Box: the foreground's bounding box. Full: the
// whole picture. Seen: pixels of the surface that an input camera sees; NaN where these are not known. All are
// composited on black; PSNR on RGB, SSIM on luma.
// A further measure requires its formula in metrics.cpp, a field here, its place in kMeasures and scorePicture
// (picture_score.cpp), a row in writeScores (lab/study/run/row_writer.cpp) and rows.h, a column in the tables that show
// it (lab/study/tables/), and a figure or an exception in site/measured/catalogue.mjs. lab/measure/held_out.h has
// scores of its own.
struct PictureScore {
  double psnr_full_db = 0, psnr_box_db = 0, psnr_fg_db = 0, psnr_common_db = 0;
  double ssim_full = 0, ssim_box = 0, ssim_fg = 0;
  double psnr_seen_db = kNaN, ssim_seen = kNaN;
};
// RGBA straight alpha, of one size. Infinite PSNR counts as 100 dB, so that means stay finite.
PictureScore scorePicture(const Image& reference, const Image& picture);
// Adds the scores over the pixels seen.
PictureScore scoreWithSeen(const Image& reference, const Image& picture, const Mask& seen);

class MeanScores {
 public:
  MeanScores();
  void add(const PictureScore& score);
  size_t count() const { return count_; }
  PictureScore mean() const;           // NaN without scores
  PictureScore standardError() const;  // standard error of the mean; NaN below two scores

 private:
  PictureScore sum_, squares_;
  size_t count_ = 0;
};

// Scores pictures on other threads while the caller draws; bounds the queue to a few pictures.
template <class Score, Score (*score)(const Image& reference, const Image& picture)>
class Lane {
 public:
  // `tag`: the caller's label of a score, e.g. a camera's name; may be empty.
  void add(Image reference, Image picture, const std::string& tag = {}) {
    start([a = std::move(reference), b = std::move(picture)] { return score(a, b); }, tag);
  }
  // Waits for all scores; returns them in the order of add.
  std::vector<std::pair<std::string, Score>> finish() {
    collect(0);
    return std::move(finished_);
  }

 protected:
  template <class Task>
  void start(Task task, const std::string& tag) {
    collect(kWaiting - 1);
    running_.emplace_back(tag, std::async(std::launch::async, std::move(task)));
  }

 private:
  static constexpr size_t kWaiting = 4;
  void collect(size_t keep) {
    for (; running_.size() > keep; running_.pop_front())
      finished_.emplace_back(running_.front().first, running_.front().second.get());
  }
  std::deque<std::pair<std::string, std::future<Score>>> running_;
  std::vector<std::pair<std::string, Score>> finished_;
};

class ScoreLane : public Lane<PictureScore, scorePicture> {
 public:
  // Scores the pixels seen, too.
  void addSeen(Image reference, Image picture, Mask seen, const std::string& tag = {}) {
    start([a = std::move(reference), b = std::move(picture), m = std::move(seen)] { return scoreWithSeen(a, b, m); },
          tag);
  }
  MeanScores finishMean();
};

}  // namespace fourdvt::measure
