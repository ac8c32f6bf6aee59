// SPDX-License-Identifier: Apache-2.0
// Grows charts from seeds and moves the seeds, alternately. Source: Pedro V. Sander, Zoë J. Wood, Steven J. Gortler,
// John Snyder, Hugues Hoppe: Multi-Chart Geometry Images. Symposium on Geometry Processing, 2003. Added here: paths
// across folds to the inside and hidden faces cost more, so that fronts meet there.
#include "track/mesh/charts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

namespace fourdvt::track {
namespace {

constexpr int kRounds = 6, kHalvingRounds = 3;
constexpr double kFlatCost = 0.15;  // cost of a metre in the direction of the chart's normal, against 1 across it
constexpr int kSmoothings = 8;
constexpr double kStraightness = 0.35;  // weight of the seams' length against the faces' lean

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr uint32_t kNone = ~uint32_t(0);

class Grower {
 public:
  Grower(const Surface& surface, FaceSet faces)
      : s_(surface),
        faces_(std::move(faces)),
        inside_(s_.faceCount(), 0),
        label_(s_.faceCount(), kNone),
        cost_(s_.faceCount(), kFar) {
    for (const uint32_t f : faces_) inside_[f] = 1;
  }

  // Adds seeds one by one, each where the others reach last, and at least one for each part of the surface.
  void seed(size_t count) {
    for (;;) {
      uint32_t worst = faces_[0];
      for (const uint32_t f : faces_)
        if (cost_[f] > cost_[worst]) worst = f;
      if (cost_[worst] == 0 || (seeds_.size() >= count && cost_[worst] < kFar)) break;
      seeds_.push_back(worst);
      proxies_.push_back(s_.normals[worst]);
      spread({uint32_t(seeds_.size()) - 1});
    }
  }

  void improve(int rounds) {
    for (int i = 0; i < rounds; ++i) {
      moveSeeds();
      for (const uint32_t f : faces_) label_[f] = kNone, cost_[f] = kFar;
      std::vector<uint32_t> all(seeds_.size());
      for (uint32_t c = 0; c < all.size(); ++c) all[c] = c;
      spread(all);
    }
  }

  void smooth() {
    for (int i = 0; i < kSmoothings; ++i) {
      findProxies();
      bool changed = false;
      for (const uint32_t f : faces_) changed |= relabel(f);
      if (!changed) return;
    }
  }

  std::vector<FaceSet> sets() const {
    std::vector<FaceSet> out;
    std::vector<uint8_t> seen(s_.faceCount(), 0);
    for (const uint32_t first : faces_) {
      if (seen[first]) continue;
      FaceSet set{first};
      seen[first] = 1;
      for (size_t i = 0; i < set.size(); ++i)
        eachNeighbour(set[i], [&](uint32_t g, uint32_t) {
          if (!seen[g] && label_[g] == label_[first]) seen[g] = 1, set.push_back(g);
        });
      std::sort(set.begin(), set.end());
      out.push_back(std::move(set));
    }
    return out;
  }

 private:
  using Item = std::tuple<double, uint32_t, uint32_t>;  // cost, face, label
  using Queue = std::priority_queue<Item, std::vector<Item>, std::greater<>>;

  template <class Use>
  void eachNeighbour(uint32_t f, Use use) const {
    for (uint32_t h = 3 * f; h < 3 * f + 3; ++h)
      if (const uint32_t g = s_.faceAcross(h); inside_[g]) use(g, h);
  }

  void spread(const std::vector<uint32_t>& labels) {
    Queue queue;
    for (const uint32_t c : labels) queue.emplace(0, seeds_[c], c);
    while (!queue.empty()) {
      const auto [cost, f, c] = queue.top();
      queue.pop();
      if (cost >= cost_[f]) continue;
      cost_[f] = cost;
      label_[f] = c;
      eachNeighbour(f, [&, cost = cost, f = f, c = c](uint32_t g, uint32_t h) {
        const double lean = 1 - glm::dot(s_.normals[g], proxies_[c]);
        const double step = glm::length(s_.centres[g] - s_.centres[f]) * (kFlatCost + lean) / s_.seam_costs[h];
        if (cost + step < cost_[g]) queue.emplace(cost + step, g, c);
      });
    }
  }

  void findProxies() {
    std::fill(proxies_.begin(), proxies_.end(), glm::dvec3(0));
    for (const uint32_t f : faces_)
      if (label_[f] != kNone) proxies_[label_[f]] += s_.areas[f] * s_.normals[f];
    for (size_t c = 0; c < proxies_.size(); ++c) {
      const double size = glm::length(proxies_[c]);
      proxies_[c] = size > 0 ? proxies_[c] / size : s_.normals[seeds_[c]];
    }
  }

  // Moves each seed to the face of its set that is farthest from the set's border.
  void moveSeeds() {
    findProxies();
    std::vector<double> depth(s_.faceCount(), kFar);
    Queue queue;
    for (const uint32_t f : faces_)
      for (uint32_t h = 3 * f; h < 3 * f + 3; ++h)
        if (const uint32_t g = s_.faceAcross(h); !inside_[g] || label_[g] != label_[f]) queue.emplace(0, f, label_[f]);
    std::vector<double> deepest(seeds_.size(), -1);
    while (!queue.empty()) {
      const auto [cost, f, c] = queue.top();
      queue.pop();
      if (cost >= depth[f]) continue;
      depth[f] = cost;
      if (cost > deepest[c]) deepest[c] = cost, seeds_[c] = f;
      eachNeighbour(f, [&, cost = cost, f = f, c = c](uint32_t g, uint32_t) {
        const double there = cost + glm::length(s_.centres[g] - s_.centres[f]);
        if (label_[g] == c && there < depth[g]) queue.emplace(there, g, c);
      });
    }
  }

  // Moves a face to the neighbouring set where its lean and the seams round it weigh less.
  bool relabel(uint32_t f) {
    const uint32_t before = label_[f];
    if (seeds_[before] == f) return false;
    const double side = std::sqrt(s_.areas[f]);
    const auto energy = [&](uint32_t c) {
      double e = s_.areas[f] * (1 - glm::dot(s_.normals[f], proxies_[c]));
      eachNeighbour(f, [&](uint32_t g, uint32_t h) {
        if (label_[g] != c) e += kStraightness * side * s_.length(h) * s_.seam_costs[h];
      });
      return e;
    };
    double least = energy(before) * (1 - 1e-9);
    eachNeighbour(f, [&](uint32_t g, uint32_t) {
      if (label_[g] == before) return;
      if (const double e = energy(label_[g]); e < least) least = e, label_[f] = label_[g];
    });
    return label_[f] != before;
  }

  const Surface& s_;
  const FaceSet faces_;
  std::vector<uint8_t> inside_;      // [face of the surface]
  std::vector<uint32_t> label_;      // [face of the surface]
  std::vector<double> cost_;         // [face of the surface] from its seed
  std::vector<uint32_t> seeds_;      // [label]
  std::vector<glm::dvec3> proxies_;  // [label] unit
};

}  // namespace

std::vector<FaceSet> grownSets(const Surface& surface, int count) {
  FaceSet all(surface.faceCount());
  for (uint32_t f = 0; f < all.size(); ++f) all[f] = f;
  Grower grower(surface, std::move(all));
  grower.seed(size_t(count));
  grower.improve(kRounds);
  grower.smooth();
  return grower.sets();
}

std::vector<FaceSet> halves(const Surface& surface, const FaceSet& set) {
  Grower grower(surface, set);
  grower.seed(2);
  grower.improve(kHalvingRounds);
  return grower.sets();
}

}  // namespace fourdvt::track
