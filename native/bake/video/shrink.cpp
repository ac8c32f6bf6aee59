// SPDX-License-Identifier: Apache-2.0
#include "bake/video/shrink.h"

#include <algorithm>
#include <vector>

namespace fourdvt::bake {
namespace {

// How much of a source texel lies under a texel of the result, in units of 1 / target of a source texel: whole numbers,
// which add up to `source` for every texel of the result.
struct Share {
  int texel = 0;
  uint32_t units = 0;
};

std::vector<std::vector<Share>> sharesOf(int source, int target) {
  std::vector<std::vector<Share>> out(static_cast<size_t>(target));
  for (int t = 0; t < target; ++t) {
    const int64_t begin = int64_t(t) * source, end = begin + source;
    for (int64_t s = begin / target; s * target < end; ++s) {
      const int64_t units = std::min(end, (s + 1) * target) - std::max(begin, s * target);
      out[static_cast<size_t>(t)].push_back({static_cast<int>(s), static_cast<uint32_t>(units)});
    }
  }
  return out;
}

// Weighted sums of one row: 3 per texel of the result.
void sumRow(const Image& source, int y, const std::vector<std::vector<Share>>& columns, std::vector<uint32_t>& out) {
  auto sum = out.begin();
  for (const std::vector<Share>& shares : columns) {
    uint32_t rgb[3] = {0, 0, 0};
    for (const Share& share : shares) {
      const uint8_t* p = source.at(share.texel, y);
      for (int c = 0; c < 3; ++c) rgb[c] += share.units * p[c];
    }
    sum = std::copy(rgb, rgb + 3, sum);
  }
}

}  // namespace

Image shrunk(const Image& source, int width, int height) {
  const auto columns = sharesOf(source.width, width), rows = sharesOf(source.height, height);
  const uint64_t whole = uint64_t(source.width) * uint64_t(source.height);
  Image out(width, height, 3);
  std::vector<uint32_t> row(size_t(3) * size_t(width));
  std::vector<uint64_t> sums(row.size());
  int summed = -1;  // the source's row that `row` holds; neighbours in the result may share one
  for (int y = 0; y < height; ++y) {
    std::fill(sums.begin(), sums.end(), whole / 2);
    for (const Share& share : rows[static_cast<size_t>(y)]) {
      if (summed != share.texel) sumRow(source, summed = share.texel, columns, row);
      for (size_t i = 0; i < row.size(); ++i) sums[i] += uint64_t(share.units) * row[i];
    }
    for (size_t i = 0; i < sums.size(); ++i) out.at(0, y)[i] = static_cast<uint8_t>(sums[i] / whole);
  }
  return out;
}

}  // namespace fourdvt::bake
