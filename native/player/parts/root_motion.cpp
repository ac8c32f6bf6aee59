// SPDX-License-Identifier: Apache-2.0
#include "player/parts/root_motion.h"

#include <algorithm>
#include <cmath>

#include "motion/mesh_blend.h"

namespace fourdvt {

void RootMotion::place(const motion::Placement& placement) {
  if (!std::isfinite(placement.ground_m.x + placement.ground_m.y + placement.heading_rad)) return;
  placement_ = placement;
  wanted_heading_rad_.reset();
}

void RootMotion::steer(double heading_rad) {
  if (std::isfinite(heading_rad)) wanted_heading_rad_ = heading_rad;
}

void RootMotion::turn(double dt_s) {
  if (!wanted_heading_rad_) return;
  const float max_turn = static_cast<float>(turn_rate_rad_s_ * dt_s);
  const float left = motion::wrapAngle(static_cast<float>(*wanted_heading_rad_) - placement_.heading_rad);
  placement_.heading_rad = motion::wrapAngle(placement_.heading_rad + std::clamp(left, -max_turn, max_turn));
}

motion::Placement RootMotion::sourcePlacement() const {
  if (!fading_) return placement_;
  return motion::moved(placement_, motion::stepBetween(fade_ * shift_, glm::vec3(0)));
}

void RootMotion::setSourcePlacement(const motion::Placement& placement) {
  placement_ = motion::moved(placement, fade_ * shift_);
}

void RootMotion::move(const glm::vec3& step, Side side) {
  if (!travel_) return;
  if (!fading_) {
    placement_ = motion::moved(placement_, step);
    return;
  }
  motion::Placement source = sourcePlacement();
  if (side == Side::Source) {
    source = motion::moved(source, (1 - fade_) * step);
  } else {
    const motion::Placement target = motion::moved(source, shift_);
    source = motion::moved(motion::moved(target, fade_ * step), motion::stepBetween(shift_, glm::vec3(0)));
  }
  setSourcePlacement(source);
}

void RootMotion::beginFade(const glm::vec3& shift) {
  fading_ = true;
  shift_ = shift;
  fade_ = 0;
}

void RootMotion::setFade(float fade) {
  const motion::Placement source = sourcePlacement();
  fade_ = fade;
  if (travel_) setSourcePlacement(source);
}

void RootMotion::cancelFade() {
  if (travel_) placement_ = sourcePlacement();
  fading_ = false;
}

void RootTrail::lead(RootMotion& motion, RootMotion::Side side, const RootFrame& to, int64_t passes) const {
  glm::vec3 from(0), pass(0);
  for (size_t m = 0; m < to.weights.size(); ++m) {
    from += to.weights[m] * roots_[m];
    pass += to.weights[m] * glm::vec3(to.sequence.members[m].travel);
  }
  for (; passes > 0; --passes) {
    motion.move(motion::stepBetween(from, pass), side);
    from = glm::vec3(0);
  }
  motion.move(motion::stepBetween(from, motion::rootOf(*to.geometry.frames, to.geometry.row, to.weights)), side);
}

void RootTrail::keep(const RootFrame& frame) {
  const size_t members = frame.sequence.members.size();
  for (size_t m = 0; m < members; ++m) roots_[m] = frame.geometry.frames->root[frame.geometry.row * members + m];
}

}  // namespace fourdvt
