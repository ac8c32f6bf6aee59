// SPDX-License-Identifier: Apache-2.0
#include "track/time.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace fourdvt::track {
namespace {

constexpr int kWrap = 12;  // frames of a loop that are repeated on both sides

// Symmetric matrix with two diagonals beside the main one; solved by LDLᵀ.
class Pentadiagonal {
 public:
  explicit Pentadiagonal(size_t size) : main_(size, 0), first_(size, 0), second_(size, 0) {}
  void clear() {
    for (auto* diagonal : {&main_, &first_, &second_}) std::fill(diagonal->begin(), diagonal->end(), 0);
  }
  void addData(size_t i, double weight) { main_[i] += weight; }
  // Adds weight (x[i-1] − 2 x[i] + x[i+1])².
  void addBend(size_t i, double weight) {
    main_[i - 1] += weight, main_[i] += 4 * weight, main_[i + 1] += weight;
    first_[i - 1] -= 2 * weight, first_[i] -= 2 * weight;
    second_[i - 1] += weight;
  }
  // Factorises; afterwards solve() may be called.
  void factorise() {
    const size_t n = main_.size();
    for (size_t i = 0; i < n; ++i) {
      if (i >= 1) main_[i] -= first_[i - 1] * first_[i - 1] * main_[i - 1];
      if (i >= 2) main_[i] -= second_[i - 2] * second_[i - 2] * main_[i - 2];
      double below = i + 1 < n ? first_[i] : 0;
      if (i >= 1 && i + 1 < n) below -= second_[i - 1] * first_[i - 1] * main_[i - 1];
      first_[i] = below / main_[i];
      second_[i] = i + 2 < n ? second_[i] / main_[i] : 0;
    }
  }
  void solve(std::vector<glm::dvec3>& x) const {
    const size_t n = main_.size();
    for (size_t i = 1; i < n; ++i) {
      x[i] -= first_[i - 1] * x[i - 1];
      if (i >= 2) x[i] -= second_[i - 2] * x[i - 2];
    }
    for (size_t i = 0; i < n; ++i) x[i] /= main_[i];
    for (size_t i = n; i-- > 0;) {
      if (i + 1 < n) x[i] -= first_[i] * x[i + 1];
      if (i + 2 < n) x[i] -= second_[i] * x[i + 2];
    }
  }

 private:
  std::vector<double> main_, first_, second_;  // second_[i]: between i and i + 2
};

}  // namespace

void smoothInTime(std::vector<Positions>& frames, std::span<const double> trust, bool loop,
                  const TimeOptions& options) {
  const int count = int(frames.size()), wrap = loop ? std::min(kWrap, count) : 0;
  const auto size = size_t(count + 2 * wrap);
  if (size < 3) return;
  const auto frameOf = [&](size_t i) { return size_t((int(i) - wrap + count) % count); };
  const double data_weight = 1 / (options.noise_m * options.noise_m);
  const double bend_weight = 1 / (options.acceleration_m * options.acceleration_m);
  inParallel(frames[0].size(), [&](size_t v) {
    std::vector<glm::dvec3> x(size);
    for (size_t i = 0; i < size; ++i) x[i] = frames[frameOf(i)][v];
    Pentadiagonal matrix(size);
    for (int round = 0; round < options.rounds; ++round) {
      matrix.clear();
      for (size_t i = 1; i + 1 < size; ++i) {
        const double bend = glm::length(x[i - 1] - 2.0 * x[i] + x[i + 1]) / options.motion_m;
        matrix.addBend(i, bend_weight / (1 + bend * bend));
      }
      for (size_t i = 0; i < size; ++i) {
        const double weight = data_weight * trust[frameOf(i)] + 1e-9 * bend_weight;
        matrix.addData(i, weight);
        x[i] = weight * glm::dvec3(frames[frameOf(i)][v]);
      }
      matrix.factorise();
      matrix.solve(x);
    }
    for (int f = 0; f < count; ++f) frames[size_t(f)][v] = glm::vec3(x[size_t(f + wrap)]);
  });
}

}  // namespace fourdvt::track
