// SPDX-License-Identifier: Apache-2.0
#include "lab/stage/counter.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "package/barcode.h"

namespace fourdvt::stage {
namespace {

constexpr uint8_t kBlack = 8, kWhite = 247;

// Mean over the middle half of a cell, of all channels.
int cellMean(const Image& rgb, int x0, int y0, int cell_px) {
  int sum = 0, count = 0;
  for (int y = y0 + cell_px / 4; y < y0 + cell_px - cell_px / 4; ++y)
    for (int x = x0 + cell_px / 4; x < x0 + cell_px - cell_px / 4; ++x)
      for (int c = 0; c < rgb.channels; ++c, ++count) sum += rgb.at(x, y)[c];
  return sum / std::max(1, count);
}

}  // namespace

std::optional<glm::ivec2> counterPlace(const Image& matte, int cell_px) {
  const int width = (kCounterColumns + 2) * cell_px, height = (kCounterRows + 2) * cell_px;
  const cv::Mat whole(matte.height, matte.width, CV_8UC1, const_cast<uint8_t*>(matte.pixels.data()));
  const cv::Mat performer = whole >= 128;
  const cv::Moments moments = cv::moments(performer, true);
  if (!(moments.m00 > 0)) return std::nullopt;
  const double from_x = moments.m10 / moments.m00 - width / 2.0, from_y = moments.m01 / moments.m00 - height / 2.0;
  cv::Mat room;  // valid corners of a counter including its margin
  cv::erode(performer, room, cv::Mat::ones(height, width, CV_8U), {0, 0}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  std::optional<glm::ivec2> best;
  double least2 = 0;
  for (int y = cell_px % 2; y < room.rows; y += 2)
    for (int x = cell_px % 2; x < room.cols; x += 2) {
      const double distance2 = (x - from_x) * (x - from_x) + (y - from_y) * (y - from_y);
      if (!room.at<uint8_t>(y, x) || (best && distance2 >= least2)) continue;
      best = glm::ivec2(x + cell_px, y + cell_px);
      least2 = distance2;
    }
  return best;
}

void drawCounter(Image& rgb, const glm::ivec2& corner, int cell_px, uint32_t number) {
  const uint16_t bits = package::barcodeBits(number);
  for (int y = 0; y < kCounterRows * cell_px; ++y)
    for (int x = 0; x < kCounterColumns * cell_px; ++x) {
      const int cell = y / cell_px * kCounterColumns + x / cell_px;
      const bool white = (bits >> (package::kBarcodeCells - 1 - cell)) & 1;
      std::fill_n(rgb.at(corner.x + x, corner.y + y), rgb.channels, white ? kWhite : kBlack);
    }
}

std::optional<uint32_t> readCounter(const Image& rgb, const glm::ivec2& corner, int cell_px) {
  if (corner.x < 0 || corner.y < 0 || corner.x + kCounterColumns * cell_px > rgb.width ||
      corner.y + kCounterRows * cell_px > rgb.height)
    return std::nullopt;
  uint16_t bits = 0;
  for (int cell = 0; cell < package::kBarcodeCells; ++cell) {
    const int x = corner.x + cell % kCounterColumns * cell_px, y = corner.y + cell / kCounterColumns * cell_px;
    bits = static_cast<uint16_t>((bits << 1) | (cellMean(rgb, x, y, cell_px) >= 128 ? 1 : 0));
  }
  return package::frameFromBarcode(bits);
}

}  // namespace fourdvt::stage
