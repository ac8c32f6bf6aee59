// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "render/passes.h"

namespace fourdvt::render {
namespace {

constexpr int kStep_px = 64;         // sizes are multiples of this, or the view's
constexpr float kMargin_px = 2;      // margin round the projected bounds: viewport rounding, samples beside the centre
constexpr int kRoomyDraws = 250;     // draws before a region shrinks
constexpr float kWholeShare = 0.9f;  // share of the view above which resolving a region costs more than it saves

}  // namespace

bool FigureRegion::update(std::span<const Figure> figures, const View& view, bool all) {
  const glm::vec2 size(view.width, view.height);
  glm::vec2 low = size, high(0);  // pixels
  for (const Figure& figure : figures) {
    const glm::mat4 clip_from_character = view.clip_from_world * figure.world_from_character;
    const BoundingBox& box = figure.model->frame_bounds;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec4 point((corner & 1 ? box.max : box.min).x, (corner & 2 ? box.max : box.min).y,
                            (corner & 4 ? box.max : box.min).z, 1);
      const glm::vec4 clip = clip_from_character * point;
      if (!(clip.w > 1e-4f)) {  // behind the eye: the box may project anywhere
        all = true;
        continue;
      }
      const glm::vec2 pixel = (glm::vec2(clip) / clip.w * 0.5f + 0.5f) * size;
      low = glm::min(low, pixel);
      high = glm::max(high, pixel);
    }
  }
  const bool same_view = view.width == view_size_[0] && view.height == view_size_[1];
  const int before[2] = {region_.width, region_.height};
  int first[2], length[2];
  view_size_[0] = view.width;
  view_size_[1] = view.height;
  for (int i = 0; i < 2; ++i) {
    low[i] = std::clamp(low[i] - kMargin_px, 0.0f, size[i]);
    high[i] = std::clamp(high[i] + kMargin_px, low[i], size[i]);
    length[i] = std::min((int(high[i] - low[i]) + 1 + kStep_px) / kStep_px * kStep_px, view_size_[i]);
  }
  roomy_draws_ = same_view && 2 * length[0] * length[1] < before[0] * before[1] ? roomy_draws_ + 1 : 0;
  for (int i = 0; i < 2; ++i)
    if (same_view && roomy_draws_ < kRoomyDraws) length[i] = std::max(length[i], before[i]);
  all = all || float(length[0]) * float(length[1]) > kWholeShare * size.x * size.y;
  for (int i = 0; i < 2; ++i) {
    if (all) length[i] = view_size_[i];
    // Centred on the bounds, within the view.
    first[i] = std::clamp(int(low[i] + high[i] - float(length[i])) / 2, 0, view_size_[i] - length[i]);
  }
  region_ = {first[0], first[1], length[0], length[1]};
  return length[0] != before[0] || length[1] != before[1];
}

}  // namespace fourdvt::render
