// SPDX-License-Identifier: Apache-2.0
#include "bake/texels/push_pull.h"

#include <algorithm>

namespace fourdvt::bake {
namespace {

struct Level {
  int size;
  std::vector<glm::vec4> texels;
};

// The mean of up to four children; the weight saturates at 1.
void push(const std::vector<glm::vec4>& fine, int fine_size, Level& coarse) {
  coarse.size = (fine_size + 1) / 2;
  coarse.texels.resize(static_cast<size_t>(coarse.size) * coarse.size);
  for (int y = 0; y < coarse.size; ++y) {
    const glm::vec4* row0 = &fine[static_cast<size_t>(2 * y) * fine_size];
    const glm::vec4* row1 = 2 * y + 1 < fine_size ? row0 + fine_size : row0;
    for (int x = 0; x < coarse.size; ++x) {
      const int x0 = 2 * x, x1 = std::min(2 * x + 1, fine_size - 1);
      const glm::vec4 sum = row0[x0] + row0[x1] + row1[x0] + row1[x1];
      coarse.texels[static_cast<size_t>(y) * coarse.size + x] = sum.w > 1 ? sum / sum.w : sum;
    }
  }
}

// Bilinear (1/4, 3/4) sample of the coarse level at fine texel (x, y).
glm::vec4 sample(const Level& coarse, int x, int y) {
  const int last = coarse.size - 1;
  const int cx = std::min(x / 2, last), cy = std::min(y / 2, last);
  const int nx = std::clamp(cx + (x % 2 ? 1 : -1), 0, last), ny = std::clamp(cy + (y % 2 ? 1 : -1), 0, last);
  const glm::vec4* near_row = &coarse.texels[static_cast<size_t>(cy) * coarse.size];
  const glm::vec4* far_row = &coarse.texels[static_cast<size_t>(ny) * coarse.size];
  return 0.5625f * near_row[cx] + 0.1875f * (near_row[nx] + far_row[cx]) + 0.0625f * far_row[nx];
}

void pull(const Level& coarse, std::vector<glm::vec4>& fine, int fine_size) {
  for (int y = 0; y < fine_size; ++y) {
    glm::vec4* row = &fine[static_cast<size_t>(y) * fine_size];
    for (int x = 0; x < fine_size; ++x) {
      if (row[x].w >= 1) continue;
      const glm::vec4 below = sample(coarse, x, y);
      if (below.w > 0) row[x] += (1 - row[x].w) / below.w * below;
    }
  }
}

}  // namespace

void pushPull(std::vector<glm::vec4>& field, int size) {
  std::vector<Level> levels;
  levels.reserve(16);
  const std::vector<glm::vec4>* fine = &field;
  for (int s = size; s > 1; s = (s + 1) / 2) {
    levels.emplace_back();
    push(*fine, s, levels.back());
    fine = &levels.back().texels;
  }
  for (size_t i = levels.size(); i-- > 0;) {
    std::vector<glm::vec4>& finer = i == 0 ? field : levels[i - 1].texels;
    pull(levels[i], finer, i == 0 ? size : levels[i - 1].size);
  }
}

}  // namespace fourdvt::bake
