// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/hybrid_blend.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

namespace fourdvt::bake {
namespace {

bool isCorner(const Shares& s) { return std::max({s.x, s.y, s.z}) > 1 - 1e-9; }

// 1 at the node, falling linearly to 0 at its neighbours on the grid of `segments`-ths, whose intervals may differ.
double straight(std::span<const Shares> nodes, size_t node, int segments, const Shares& at) {
  if (at.z == 0 && std::all_of(nodes.begin(), nodes.end(), [](const Shares& n) { return n.z == 0; })) {
    const double before = node > 0 ? nodes[node - 1].y : 0, here = nodes[node].y;
    const double after = node + 1 < nodes.size() ? nodes[node + 1].y : 1;
    return std::max(0.0, std::min((at.y - before) / (here - before), (after - at.y) / (after - here)));
  }
  const Shares d = glm::abs(at - nodes[node]) * double(segments);
  return std::max(0.0, 1 - std::max({d.x, d.y, d.z}));
}

// Lagrange's polynomial: 1 at the node, 0 at the other nodes and at both ends.
double polynomial(std::span<const Shares> nodes, size_t node, const Shares& at) {
  const double here = nodes[node].y;
  double value = at.y / here * (1 - at.y) / (1 - here);
  for (size_t n = 0; n < nodes.size(); ++n)
    if (n != node) value *= (at.y - nodes[n].y) / (here - nodes[n].y);
  return value;
}

// Where the node at `share` of an interval goes, evenly spaced by `segments`-ths, so that all are Chebyshev's points.
double stretched(double share, int segments) {
  const double angle = std::numbers::pi / (2 * segments + 2);
  return (1 - std::cos((2 * segments * share + 1) * angle) / std::cos(angle)) / 2;
}

Positions difference(const Positions& a, const Positions& b) {
  Positions out(a.size());
  for (size_t v = 0; v < a.size(); ++v) out[v] = a[v] - b[v];
  return out;
}

}  // namespace

std::vector<float> simplexWeights(const BlendSimplex& simplex, const Shares& shares, size_t member_count) {
  std::vector<float> weights(member_count, 0);
  for (int i = 0; i < 3; ++i) weights[size_t(simplex.members[i])] += float(shares[i]);
  return weights;
}

std::vector<Shares> simplexGrid(bool interval, int segments) {
  std::vector<Shares> points;
  for (int y = 0; y <= segments; ++y) {
    for (int z = 0; z <= (interval ? 0 : segments - y); ++z)
      points.push_back(Shares(segments - y - z, y, z) / double(segments));
  }
  return points;
}

std::vector<Shares> hybridNodes(bool interval, int segments, int check_segments, HybridMix mix) {
  std::vector<Shares> nodes;
  for (Shares node : simplexGrid(interval, segments)) {
    if (isCorner(node)) continue;
    if (interval) {
      if (mix == HybridMix::Polynomial) node.y = stretched(node.y, segments);
      node.y = std::round(node.y * check_segments) / check_segments;
      node.x = 1 - node.y;
    }
    nodes.push_back(node);
  }
  return nodes;
}

std::vector<double> hybridCoefficients(std::span<const Shares> nodes, int segments, HybridMix mix, const Shares& at) {
  std::vector<double> coefficients;
  for (size_t n = 0; n < nodes.size(); ++n) {
    coefficients.push_back(mix == HybridMix::Polynomial ? polynomial(nodes, n, at) : straight(nodes, n, segments, at));
  }
  return coefficients;
}

HybridErrors::HybridErrors(const BlendSimplex& simplex, HybridMix mix, int check_segments, int max_segments)
    : simplex_(simplex), points_(simplexGrid(simplex.interval(), check_segments)) {
  for (int segments = 1; segments <= max_segments; ++segments) {
    Level level;
    const auto nodes = hybridNodes(simplex.interval(), segments, check_segments, mix);
    for (const Shares& node : nodes) {
      const auto near = [&](const Shares& a, const Shares& b) { return glm::length(a - node) < glm::length(b - node); };
      level.nodes.push_back(size_t(std::min_element(points_.begin(), points_.end(), near) - points_.begin()));
    }
    for (const Shares& point : points_) {
      const auto shares = hybridCoefficients(nodes, segments, mix, point);
      level.coefficients.emplace_back(shares.begin(), shares.end());
    }
    levels_.push_back(std::move(level));
  }
}

void HybridErrors::add(const NonlinearBlend& blend, std::span<const Positions> members) {
  std::vector<Positions> corrections(points_.size());
  cv::parallel_for_(cv::Range(0, int(points_.size())), [&](const cv::Range& range) {
    for (size_t c = size_t(range.start); c < size_t(range.end); ++c) {
      if (isCorner(points_[c])) continue;
      const std::vector<float> weights = simplexWeights(simplex_, points_[c], members.size());
      corrections[c] = difference(blend.blend(members, weights), linearBlend(members, weights));
    }
  });
  for (Level& level : levels_) {
    for (size_t c = 0; c < points_.size(); ++c) {
      Positions left = corrections[c];
      for (size_t n = 0; n < level.nodes.size() && !left.empty(); ++n) {
        const float share = level.coefficients[c][n];
        for (size_t v = 0; share != 0 && v < left.size(); ++v) left[v] -= share * corrections[level.nodes[n]][v];
      }
      for (const glm::vec3& d : left) {
        const double squared = glm::dot(d, d);
        level.error.max_m = std::max(level.error.max_m, std::sqrt(squared));
        level.error.sum_squares += squared;
      }
      level.error.count += left.size();
    }
  }
}

}  // namespace fourdvt::bake
