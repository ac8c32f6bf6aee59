// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "lab/studio/actors/actor.h"

namespace fourdvt::studio {
namespace {

class StridingActor final : public Actor {
 public:
  StridingActor(std::unique_ptr<Actor> one, double strides, bool travel) : one_(std::move(one)), strides_(strides) {
    for (const Motion& motion : one_->motions()) {
      Motion& own = motions_.emplace_back(motion);
      ways_.emplace_back(0);
      if (!motion.is_gait) continue;
      own = {motion.name, strides * motion.duration_s, false, motion.root_velocity_mps};
      if (travel) ways_.back() = own.duration_s * std::exchange(own.root_velocity_mps, glm::dvec3(0));
    }
  }

  const std::vector<Motion>& motions() const override { return motions_; }
  const RestMesh& surface() const override { return one_->surface(); }
  const RestMesh& tracked() const override { return one_->tracked(); }
  const Image& texture() const override { return one_->texture(); }

  void pose(std::span<const double> shares, double phase, Positions& out) override {
    double passes = 0;
    glm::dvec3 way(0);
    for (size_t m = 0; m < shares.size(); ++m) {
      passes += shares[m] * (one_->motions()[m].is_gait ? strides_ : 1);
      way += shares[m] * ways_[m];
    }
    const bool whole = passes == 1;  // the last pose of a motion with an end is not its first
    one_->pose(shares, whole ? phase : passes * phase - std::floor(passes * phase), out);
    const glm::vec3 shift((phase - 0.5) * way);
    for (glm::vec3& p : out) p += shift;
  }

 private:
  const std::unique_ptr<Actor> one_;
  const double strides_;
  std::vector<Motion> motions_;
  std::vector<glm::dvec3> ways_;  // [motion] metres from the first to the last frame
};

}  // namespace

std::unique_ptr<Actor> withStrides(std::unique_ptr<Actor> actor, double strides, bool travel) {
  return std::make_unique<StridingActor>(std::move(actor), strides, travel);
}

}  // namespace fourdvt::studio
