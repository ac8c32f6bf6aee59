// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "bake/align/surface_alignment.h"

namespace fourdvt::bake {
namespace {

constexpr float kSteadiness = 0.25f;     // pull towards each neighbour in time, against confidence 0..1
constexpr float kMinConfidence = 1e-3f;  // every vertex has this much, so that one that is never certain keeps its mean

// One tridiagonal system: confidence_t (x_t − d_t) + kSteadiness Σ (x_t − x_neighbour) = 0.
class TimeLine {
 public:
  TimeLine(size_t count, bool loop) : diagonal_(count), right_(count), loop_(loop && count > 2) {}

  void set(size_t t, float confidence, const glm::vec2& value) {
    const size_t last = diagonal_.size() - 1;
    const float neighbours = loop_ ? 2.0f : float(t > 0) + float(t < last);
    diagonal_[t] = confidence + kMinConfidence + kSteadiness * neighbours;
    right_[t] = (confidence + kMinConfidence) * value;
  }

  const std::vector<glm::vec2>& solve() {
    if (!loop_) {
      sweep(diagonal_, right_);
      return right_;
    }
    // Cyclic: Sherman–Morrison with u = (γ, 0, …, −s), v = (1, 0, …, −s/γ); γ = −diagonal_0.
    const size_t last = diagonal_.size() - 1;
    const float gamma = -diagonal_[0], ratio = -kSteadiness / gamma;
    std::vector<glm::vec2> correction(diagonal_.size(), glm::vec2(0));
    correction[0] = glm::vec2(gamma);
    correction[last] = glm::vec2(-kSteadiness);
    diagonal_[0] -= gamma;
    diagonal_[last] += kSteadiness * ratio;
    sweep(diagonal_, right_);
    sweep(diagonal_, correction);
    const glm::vec2 share = (right_[0] + ratio * right_[last]) / (1.0f + correction[0] + ratio * correction[last]);
    for (size_t t = 0; t <= last; ++t) right_[t] -= share * correction[t];
    return right_;
  }

 private:
  // Solves with off-diagonals −kSteadiness, in place.
  static void sweep(const std::vector<float>& diagonal, std::vector<glm::vec2>& values) {
    std::vector<float> upper(diagonal.size(), 0);
    float pivot = diagonal[0];
    values[0] /= pivot;
    for (size_t t = 1; t < diagonal.size(); ++t) {
      upper[t - 1] = -kSteadiness / pivot;
      pivot = diagonal[t] + kSteadiness * upper[t - 1];
      values[t] = (values[t] + kSteadiness * values[t - 1]) / pivot;
    }
    for (size_t t = diagonal.size() - 1; t-- > 0;) values[t] -= upper[t] * values[t + 1];
  }

  std::vector<float> diagonal_;
  std::vector<glm::vec2> right_;
  bool loop_ = false;
};

}  // namespace

void steadyAlignment(std::vector<AlignedFrame>& frames, bool loop) {
  if (frames.size() < 2) return;
  const size_t count = frames[0].displacement_m.size();
  for (size_t i = 0; i < count; ++i) {
    TimeLine line(frames.size(), loop);
    for (size_t t = 0; t < frames.size(); ++t) line.set(t, frames[t].confidence[i], frames[t].displacement_m[i]);
    const std::vector<glm::vec2>& steady = line.solve();
    for (size_t t = 0; t < frames.size(); ++t) frames[t].displacement_m[i] = steady[t];
  }
}

}  // namespace fourdvt::bake
