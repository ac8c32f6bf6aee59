// SPDX-License-Identifier: Apache-2.0
#include "bake/labels/statistics.h"

#include <algorithm>
#include <bit>

#include "package/character.h"

namespace fourdvt::bake {
namespace {

double percent(uint64_t part, double whole) { return whole > 0 ? 100 * double(part) / whole : 0; }

// Per face, 1: a camera sees it.
std::vector<uint8_t> seenFaces(const FaceCosts& costs, size_t faces) {
  std::vector<uint8_t> seen(faces, 1);
  for (size_t f = 0; f < costs.unseen.size(); ++f) seen[f] = !costs.unseen[f];
  return seen;
}

}  // namespace

LabelMeter::LabelMeter(const LabelOptions& options, const FaceGraph& graph)
    : options_(options), graph_(graph), layers_(options.layers) {}

// ALGORITHMS 1.3: d(a,b) = Σ_l ω_l [a_l ≠ b_l] + (η/2) |S_a Δ S_b|.
double LabelMeter::distance(const std::vector<uint8_t>& a, size_t f, const std::vector<uint8_t>& b, size_t g) const {
  double sum = 0;
  uint32_t set_a = 0, set_b = 0;
  for (int l = 0; l < options_.layers; ++l) {
    const uint8_t x = a[l * graph_.face_count + f], y = b[l * graph_.face_count + g];
    if (x != y) sum += weightOfRank(options_.omega, l);
    if (x != package::kNoCamera) set_a |= 1u << x;
    if (y != package::kNoCamera) set_b |= 1u << y;
  }
  return sum + 0.5 * options_.eta * std::popcount(set_a ^ set_b);
}

void LabelMeter::addLayer(const FaceCosts& costs, const uint8_t* layer, int l, const std::vector<uint8_t>& seen) {
  Counts& counts = layers_[l];
  const auto count = [](uint8_t a, uint8_t b, bool is_seen, uint64_t& all, uint64_t& cameras, uint64_t& of_seen) {
    if (a == b) return;
    ++all;
    if (a != package::kNoCamera && b != package::kNoCamera) ++cameras;
    if (is_seen) ++of_seen;
  };
  const size_t faces = graph_.face_count;
  for (size_t f = 0; f < faces; ++f) {
    const bool filled = layer[f] != package::kNoCamera;
    const double p = filled ? costs.penalty[f * costs.camera_count + layer[f]] : options_.empty_penalty;
    energy_ += weightOfRank(options_.theta, l) * p;
    if (filled) ++counts.filled;
    if (filled && seen[f]) ++counts.filled_seen, counts.penalty += p;
    if (frames_ > 0)
      count(layer[f], previous_[l * faces + f], seen[f] && previous_seen_[f], counts.flips, counts.camera_flips,
            counts.seen_flips);
  }
  for (auto [f, g] : graph_.edges)
    count(layer[f], layer[g], seen[f] && seen[g], counts.seams, counts.camera_seams, counts.seen_seams);
}

void LabelMeter::add(const FaceCosts& costs, const std::vector<uint8_t>& labels) {
  const size_t faces = graph_.face_count;
  std::vector<uint8_t> seen = seenFaces(costs, faces);
  for (int l = 0; l < options_.layers; ++l) addLayer(costs, labels.data() + l * faces, l, seen);
  for (auto [f, g] : graph_.edges) {
    energy_ += (1.0 / graph_.neighbour_count[f] + 1.0 / graph_.neighbour_count[g]) * distance(labels, f, labels, g);
    seen_edges_ += seen[f] && seen[g];
  }
  for (size_t f = 0; frames_ > 0 && f < faces; ++f) {
    energy_ += options_.tau * distance(labels, f, previous_, f);
    seen_steps_ += seen[f] && previous_seen_[f];
  }
  previous_ = labels;
  previous_seen_ = std::move(seen);
  ++frames_;
}

LabelStatistics LabelMeter::statistics() const {
  LabelStatistics out;
  out.frames = frames_;
  out.energy = energy_;
  const double faces = graph_.face_count, ranks = faces * options_.layers * frames_;
  const double edges = static_cast<double>(graph_.edges.size()) * frames_;
  const double steps = faces * (frames_ > 1 ? frames_ - 1 : 0);
  double filled = 0;
  for (const Counts& counts : layers_) {
    out.seam_percent.push_back(percent(counts.seams, edges));
    out.flip_percent.push_back(percent(counts.flips, steps));
    out.camera_seam_percent.push_back(percent(counts.camera_seams, edges));
    out.camera_flip_percent.push_back(percent(counts.camera_flips, steps));
    out.seen_seam_percent.push_back(percent(counts.seen_seams, double(seen_edges_)));
    out.seen_flip_percent.push_back(percent(counts.seen_flips, double(seen_steps_)));
    out.mean_penalty.push_back(counts.filled_seen ? counts.penalty / double(counts.filled_seen) : 0);
    filled += double(counts.filled);
  }
  out.empty_percent = ranks > 0 ? 100 * (1 - filled / ranks) : 0;
  return out;
}

}  // namespace fourdvt::bake
