// SPDX-License-Identifier: Apache-2.0
#include "bake/labels/statistics.h"

#include <algorithm>
#include <bit>

#include "package/character.h"

namespace fourdvt::bake {
namespace {

void count(uint8_t a, uint8_t b, uint64_t& all, uint64_t& cameras) {
  if (a == b) return;
  ++all;
  if (a != package::kNoCamera && b != package::kNoCamera) ++cameras;
}

}  // namespace

LabelMeter::LabelMeter(const LabelOptions& options, const FaceGraph& graph)
    : options_(options),
      graph_(graph),
      seams_(options.layers),
      flips_(options.layers),
      camera_seams_(options.layers),
      camera_flips_(options.layers),
      filled_(options.layers),
      seen_(options.layers),
      penalties_(options.layers) {}

// ALGORITHMS 1.3: d(a,b) = Σ_l ω_l [a_l ≠ b_l] + (η/2) |S_a Δ S_b|.
double LabelMeter::distance(const std::vector<uint8_t>& a, size_t f, const std::vector<uint8_t>& b, size_t g) const {
  double sum = 0;
  uint32_t set_a = 0, set_b = 0;
  for (int l = 0; l < options_.layers; ++l) {
    const uint8_t x = a[l * graph_.face_count + f], y = b[l * graph_.face_count + g];
    if (x != y) sum += weightOfSlot(options_.omega, l);
    if (x != package::kNoCamera) set_a |= 1u << x;
    if (y != package::kNoCamera) set_b |= 1u << y;
  }
  return sum + 0.5 * options_.eta * std::popcount(set_a ^ set_b);
}

void LabelMeter::add(const FaceCosts& costs, const std::vector<uint8_t>& labels) {
  const size_t faces = graph_.face_count;
  for (int l = 0; l < options_.layers; ++l) {
    const uint8_t* layer = labels.data() + l * faces;
    for (size_t f = 0; f < faces; ++f) {
      const bool filled = layer[f] != package::kNoCamera;
      const double p = filled ? costs.penalty[f * costs.camera_count + layer[f]] : options_.empty_penalty;
      energy_ += weightOfSlot(options_.theta, l) * p;
      if (filled) ++filled_[l];
      if (filled && (costs.unseen.empty() || !costs.unseen[f])) ++seen_[l], penalties_[l] += p;
      if (frames_ > 0) count(layer[f], previous_[l * faces + f], flips_[l], camera_flips_[l]);
    }
    for (auto [f, g] : graph_.edges) count(layer[f], layer[g], seams_[l], camera_seams_[l]);
  }
  for (auto [f, g] : graph_.edges)
    energy_ += (1.0 / graph_.neighbour_count[f] + 1.0 / graph_.neighbour_count[g]) * distance(labels, f, labels, g);
  if (frames_ > 0)
    for (size_t f = 0; f < faces; ++f) energy_ += options_.tau * distance(labels, f, previous_, f);
  previous_ = labels;
  ++frames_;
}

LabelStatistics LabelMeter::statistics() const {
  LabelStatistics out;
  out.frames = frames_;
  out.energy = energy_;
  const double faces = graph_.face_count, slots = faces * options_.layers * frames_;
  const double edges = static_cast<double>(graph_.edges.size()) * frames_;
  const double steps = faces * (frames_ > 1 ? frames_ - 1 : 0);
  double filled = 0;
  for (int l = 0; l < options_.layers; ++l) {
    out.seam_percent.push_back(edges > 0 ? 100 * seams_[l] / edges : 0);
    out.flip_percent.push_back(steps > 0 ? 100 * flips_[l] / steps : 0);
    out.camera_seam_percent.push_back(edges > 0 ? 100 * camera_seams_[l] / edges : 0);
    out.camera_flip_percent.push_back(steps > 0 ? 100 * camera_flips_[l] / steps : 0);
    out.mean_penalty.push_back(seen_[l] ? penalties_[l] / seen_[l] : 0);
    filled += filled_[l];
  }
  out.empty_percent = slots > 0 ? 100 * (1 - filled / slots) : 0;
  return out;
}

}  // namespace fourdvt::bake
