// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "render/passes.h"

namespace fourdvt::render {
namespace {

constexpr int kStep_px = 64;      // sizes are multiples of it, or the view's
constexpr float kMargin_px = 2;   // round the projected bounds: rounding of a viewport, samples beside the centre
constexpr int kRoomyDraws = 250;  // until a region shrinks
constexpr float kWholeShare =
    0.9f;  // of the view: from here on the picture that is resolved to costs more than is saved

struct Rectangle {
  glm::vec2 min{INFINITY}, max{-INFINITY};  // pixels
};

// Grows the rectangle by the projected corners. False: one lies behind the eye, so that the box may be seen anywhere.
bool addBox(const BoundingBox& box, const glm::mat4& clip_from_character, const glm::vec2& size, Rectangle& out) {
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 point(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                          corner & 4 ? box.max.z : box.min.z);
    const glm::vec4 clip = clip_from_character * glm::vec4(point, 1);
    if (!(clip.w > 1e-4f)) return false;
    const glm::vec2 pixel = (glm::vec2(clip) / clip.w * 0.5f + 0.5f) * size;
    out.min = glm::min(out.min, pixel);
    out.max = glm::max(out.max, pixel);
  }
  return true;
}

int roundedUp(float length_px, int most) {
  return std::min((int(length_px) + kStep_px - 1) / kStep_px * kStep_px, most);
}

// Where `length` pixels lie round the middle of low…high, inside of the view.
int placed(float low, float high, int length, int view_length) {
  return std::clamp(int(std::floor((low + high - float(length)) / 2)), 0, view_length - length);
}

}  // namespace

bool FigureRegion::update(std::span<const Figure> figures, const View& view, bool all) {
  const glm::vec2 size(view.width, view.height);
  Rectangle needed;
  for (const Figure& figure : figures)
    all = all || !addBox(figure.model->frame_bounds, view.clip_from_world * figure.world_from_character, size, needed);
  const glm::vec2 low = glm::clamp(needed.min - kMargin_px, glm::vec2(0), size);
  const glm::vec2 high = glm::clamp(needed.max + kMargin_px, low, size);
  int width = all ? view.width : std::max(roundedUp(std::ceil(high.x - low.x) + 1, view.width), 1);
  int height = all ? view.height : std::max(roundedUp(std::ceil(high.y - low.y) + 1, view.height), 1);
  const gpu::Region before = region_;
  const bool same_view = view.width == view_width_ && view.height == view_height_;
  const auto area = [](int w, int h) { return float(w) * float(h); };
  roomy_draws_ = same_view && 2 * area(width, height) < area(before.width, before.height) ? roomy_draws_ + 1 : 0;
  if (same_view && roomy_draws_ < kRoomyDraws) {
    width = std::max(width, before.width);
    height = std::max(height, before.height);
  }
  if (area(width, height) > kWholeShare * area(view.width, view.height)) width = view.width, height = view.height;
  view_width_ = view.width;
  view_height_ = view.height;
  region_ = {placed(low.x, high.x, width, view.width), placed(low.y, high.y, height, view.height), width, height};
  return width != before.width || height != before.height;
}

}  // namespace fourdvt::render
