// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "mattes/run/report.h"
#include "report/picture_sheets.h"

namespace fourdvt::mattes {
namespace {

constexpr std::array<uint8_t, 3> kBehind{214, 60, 190};  // colour behind the performer, which makes holes and fringes
                                                         // visible

std::array<int, 3> tintOf(uint8_t dropped) {
  if (dropped == 255) return {255, 40, 40};
  if (dropped == 128) return {60, 110, 255};
  return {250, 210, 30};
}

}  // namespace

Image contactCell(const Image& picture, const CameraMatte& matte) {
  const int width = std::max(1, picture.width * kCellHeight / picture.height);
  const Image small = report::scaledTo(picture, width, kCellHeight);
  Image alpha(picture.width, picture.height, 3), why(picture.width, picture.height, 3);
  for (size_t i = 0; i < matte.matte.pixels.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) alpha.pixels[3 * i + c] = matte.matte.pixels[i];
    if (!matte.dropped.empty()) why.pixels[3 * i] = matte.dropped.at<uint8_t>(int(i)) > 0 ? 255 : 0;
  }
  alpha = report::scaledTo(alpha, width, kCellHeight);
  why = report::scaledTo(why, width, kCellHeight);
  const auto inside = [&](int x, int y) {
    return *alpha.at(std::clamp(x, 0, width - 1), std::clamp(y, 0, kCellHeight - 1)) >= 128;
  };
  Image out(width, 2 * kCellHeight, 3);
  for (int y = 0; y < kCellHeight; ++y)
    for (int x = 0; x < width; ++x) {
      const uint8_t* from = small.at(x, y);
      uint8_t *over = out.at(x, y), *alone = out.at(x, y + kCellHeight);
      const bool in = inside(x, y);
      const bool edge = in && !(inside(x - 1, y) && inside(x + 1, y) && inside(x, y - 1) && inside(x, y + 1));
      for (int c = 0; c < 3; ++c) {
        over[c] = uint8_t(in ? from[c] : from[c] * 0.5);
        const int a = *alpha.at(x, y);
        alone[c] = uint8_t((from[c] * a + kBehind[size_t(c)] * (255 - a)) / 255);
      }
      if (!in && *why.at(x, y) >= 128) {
        const auto tint =
            tintOf(matte.dropped.at<uint8_t>(y * picture.height / kCellHeight, x * picture.width / width));
        for (int c = 0; c < 3; ++c) over[c] = uint8_t((over[c] + tint[size_t(c)]) / 2);
      }
      if (edge) over[0] = 40, over[1] = 230, over[2] = 70;
    }
  return out;
}

}  // namespace fourdvt::mattes
