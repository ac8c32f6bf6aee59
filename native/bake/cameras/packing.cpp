// SPDX-License-Identifier: Apache-2.0
#include "bake/cameras/packing.h"

#include <algorithm>
#include <numeric>

namespace fourdvt::bake {
namespace {

struct Step {  // of the skyline: from x to the next step's x everything above y is taken
  int x, y;
};

class Skyline {
 public:
  explicit Skyline(int width) : width_(width), steps_{{0, 0}} {}

  glm::ivec2 place(const glm::ivec2& size) {
    size_t best = 0;
    int best_y = heightFor(0, size.x);
    for (size_t s = 1; s < steps_.size() && steps_[s].x + size.x <= width_; ++s) {
      const int y = heightFor(s, size.x);
      if (y < best_y) best = s, best_y = y;
    }
    const int x = steps_[best].x;
    raise(best, x + size.x, best_y + size.y);
    return {x, best_y};
  }

 private:
  int endOf(size_t s) const { return s + 1 < steps_.size() ? steps_[s + 1].x : width_; }

  // How far down a rectangle lies that begins with this step.
  int heightFor(size_t s, int width) const {
    int y = 0;
    for (const int end = steps_[s].x + width; s < steps_.size() && steps_[s].x < end; ++s) y = std::max(y, steps_[s].y);
    return y;
  }

  // From the beginning of a step to x = end, the skyline is at y.
  void raise(size_t first, int end, int y) {
    size_t last = first;
    while (last + 1 < steps_.size() && steps_[last + 1].x < end) ++last;
    const Step rest{end, steps_[last].y};
    const bool has_rest = endOf(last) > end;
    steps_[first].y = y;
    steps_.erase(steps_.begin() + long(first) + 1, steps_.begin() + long(last) + 1);
    if (has_rest) steps_.insert(steps_.begin() + long(first) + 1, rest);
  }

  const int width_;
  std::vector<Step> steps_;
};

}  // namespace

Packing packInto(std::span<const glm::ivec2> sizes, int width) {
  std::vector<size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return sizes[a].y != sizes[b].y ? sizes[a].y > sizes[b].y : sizes[a].x > sizes[b].x;
  });
  Packing out{0, std::vector<glm::ivec2>(sizes.size(), glm::ivec2(0))};
  Skyline skyline(width);
  for (const size_t i : order) {
    if (sizes[i].x <= 0 || sizes[i].y <= 0) continue;
    out.places[i] = skyline.place(sizes[i]);
    out.height = std::max(out.height, out.places[i].y + sizes[i].y);
  }
  return out;
}

}  // namespace fourdvt::bake
