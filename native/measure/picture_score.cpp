// SPDX-License-Identifier: Apache-2.0
#include "measure/picture_score.h"

#include <algorithm>
#include <cmath>

#include "measure/metrics.h"

namespace fourdvt::measure {
namespace {

double capped(double psnr_db) { return std::isinf(psnr_db) ? kEqual_db : psnr_db; }

struct Box {
  int x0, y0, x1, y1;
};

Box boundingBox(const Mask& mask, int width, int height) {
  Box box{width, height, 0, 0};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!mask[static_cast<size_t>(y) * width + x]) continue;
      box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1), std::max(box.y1, y + 1)};
    }
  return box;
}

Image cropped(const Image& image, const Box& box) {
  Image out(box.x1 - box.x0, box.y1 - box.y0, image.channels);
  for (int y = 0; y < out.height; ++y)
    std::copy_n(image.at(box.x0, box.y0 + y), static_cast<size_t>(out.width) * out.channels, out.at(0, y));
  return out;
}

// Bounding box of the non-black pixels of both pictures, extended by the radius of SSIM's window.
Box contentBox(const Image& a, const Image& b) {
  Mask mask(static_cast<size_t>(a.width) * a.height);
  for (size_t i = 0; i < mask.size(); ++i)
    for (int c = 0; c < 3; ++c) mask[i] |= a.pixels[3 * i + c] | b.pixels[3 * i + c];
  Box box = boundingBox(mask, a.width, a.height);
  if (box.x0 >= box.x1) return {0, 0, a.width, a.height};
  const int reach = kSsimWindow;
  return {std::max(0, box.x0 - reach), std::max(0, box.y0 - reach), std::min(a.width, box.x1 + reach),
          std::min(a.height, box.y1 + reach)};
}

constexpr double PictureScore::*kMeasures[] = {
    &PictureScore::psnr_full_db,   &PictureScore::psnr_box_db,  &PictureScore::psnr_fg_db,
    &PictureScore::psnr_common_db, &PictureScore::ssim_full,    &PictureScore::ssim_box,
    &PictureScore::ssim_fg,        &PictureScore::psnr_seen_db, &PictureScore::ssim_seen};

// seen: may be null.
PictureScore scored(const Image& reference, const Image& picture, const Mask* seen) {
  const Mask fg = unionOfSilhouettes(reference, picture);
  const Image a = compositedOnBlack(reference), b = compositedOnBlack(picture);
  const int w = a.width, h = a.height;
  PictureScore out;
  out.psnr_full_db = capped(psnr(a, b, Mask(fg.size(), 1)));
  out.psnr_fg_db = capped(psnr(a, b, fg));
  out.psnr_common_db = capped(psnr(a, b, commonSilhouette(reference, picture)));
  const Box box = boundingBox(fg, w, h), content = contentBox(a, b);
  Mask in_box(fg.size(), 0);
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) in_box[static_cast<size_t>(y) * w + x] = 1;
  out.psnr_box_db = capped(psnr(a, b, in_box));
  const std::vector<double> map = ssimMap(cropped(a, content), cropped(b, content));
  double full = 0, boxed = 0, inside = 0, seen_sum = 0;
  size_t full_count = 0, boxed_count = 0, inside_count = 0, seen_count = 0;
  const int reach = kSsimWindow / 2;
  for (int y = reach; y < h - reach; ++y)
    for (int x = reach; x < w - reach; ++x) {
      const size_t i = static_cast<size_t>(y) * w + x;
      const bool mapped =
          x >= content.x0 + reach && x < content.x1 - reach && y >= content.y0 + reach && y < content.y1 - reach;
      const double value =
          mapped ? map[static_cast<size_t>(y - content.y0) * (content.x1 - content.x0) + x - content.x0] : 1;
      full += value, ++full_count;
      if (in_box[i]) boxed += value, ++boxed_count;
      if (fg[i]) inside += value, ++inside_count;
      if (seen && (*seen)[i]) seen_sum += value, ++seen_count;
    }
  out.ssim_full = full / static_cast<double>(full_count);
  out.ssim_box = boxed / static_cast<double>(boxed_count);
  out.ssim_fg = inside / static_cast<double>(inside_count);
  if (!seen) return out;
  out.psnr_seen_db = capped(psnr(a, b, *seen));
  out.ssim_seen = seen_sum / static_cast<double>(seen_count);
  return out;
}

}  // namespace

PictureScore scorePicture(const Image& reference, const Image& picture) { return scored(reference, picture, nullptr); }

PictureScore scoreWithSeen(const Image& reference, const Image& picture, const Mask& seen) {
  return scored(reference, picture, &seen);
}

MeanScores::MeanScores() {
  for (const auto measure : kMeasures) sum_.*measure = squares_.*measure = 0;
}

void MeanScores::add(const PictureScore& score) {
  for (const auto measure : kMeasures) {
    sum_.*measure += score.*measure;
    squares_.*measure += score.*measure * (score.*measure);
  }
  ++count_;
}

PictureScore MeanScores::mean() const {
  PictureScore mean = sum_;
  for (const auto measure : kMeasures) mean.*measure /= static_cast<double>(count_);
  return mean;
}

PictureScore MeanScores::standardError() const {
  const double n = static_cast<double>(count_);
  PictureScore error;
  for (const auto measure : kMeasures) {
    const double mean = sum_.*measure / n, variance = std::max(0.0, squares_.*measure / n - mean * mean);
    error.*measure = count_ < 2 ? std::nan("") : std::sqrt(variance / (n - 1));
  }
  return error;
}

MeanScores ScoreLane::finishMean() {
  MeanScores mean;
  for (const auto& [tag, score] : finish()) mean.add(score);
  return mean;
}

}  // namespace fourdvt::measure
