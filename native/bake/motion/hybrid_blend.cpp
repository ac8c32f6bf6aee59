// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/hybrid_blend.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/parallel.h"

namespace fourdvt::bake {
namespace {

bool isCorner(const Shares& s) { return std::max({s.x, s.y, s.z}) > 1 - 1e-9; }

// Hat function: 1 at the node, falling linearly to 0 at its neighbours on the grid of `segments`-ths, whose intervals
// may differ.
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

// Position of the node at `share` of an interval, evenly spaced by `segments`-ths, mapped to Chebyshev's points.
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
  inParallel(points_.size(), [&](size_t c) {
    if (isCorner(points_[c])) return;
    const std::vector<float> weights = simplexWeights(simplex_, points_[c], members.size());
    corrections[c] = difference(blend.blend(members, weights), linearBlend(members, weights));
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

namespace {

using package::Member;
using package::ParameterSample;
using package::ParameterSpace;

constexpr int kIntervalSteps = 32, kTriangleSteps = 12;  // steps of the table per simplex

Error impossible(const std::string& place, const std::string& what) {
  return {ErrorId::CaptureJson, place + ": " + what};
}

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

std::vector<glm::dvec2> scaledPoints(const std::vector<Member>& members) {
  std::vector<glm::dvec2> points;
  glm::dvec2 low(1e300), high(-1e300);
  for (const Member& m : members) {
    points.emplace_back(m.parameter[0], m.parameter[1]);
    low = glm::min(low, points.back());
    high = glm::max(high, points.back());
  }
  for (glm::dvec2& p : points) p = (p - low) / glm::max(high - low, glm::dvec2(1e-12));
  return points;
}

bool inside(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  const double x = cross(b - a, p - a), y = cross(c - b, p - b), z = cross(a - c, p - c);
  return (x > 0 && y > 0 && z > 0) || (x < 0 && y < 0 && z < 0);
}

std::vector<BlendSimplex> quadTriangles(const std::vector<glm::dvec2>& p) {
  for (int i = 0; i < 4; ++i) {
    const int a = (i + 1) % 4, b = (i + 2) % 4, c = (i + 3) % 4;
    if (inside(p[i], p[a], p[b], p[c])) return {{{a, b, i}}, {{b, c, i}}, {{c, a, i}}};
  }
  std::array<int, 4> order = {0, 1, 2, 3};  // members in angular order round their centroid
  const glm::dvec2 middle = (p[0] + p[1] + p[2] + p[3]) / 4.0;
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::atan2(p[a].y - middle.y, p[a].x - middle.x) < std::atan2(p[b].y - middle.y, p[b].x - middle.x);
  });
  const auto [a, b, c, d] = order;
  if (glm::distance(p[a], p[c]) <= glm::distance(p[b], p[d])) return {{{a, b, c}}, {{a, c, d}}};
  return {{{a, b, d}}, {{b, c, d}}};
}

double mixedSpeed(const std::vector<Member>& members, const std::vector<float>& weights) {
  glm::dvec2 travel(0);
  double duration_s = 0;
  for (size_t m = 0; m < members.size(); ++m) {
    travel += double(weights[m]) * glm::dvec2(members[m].travel);
    duration_s += double(weights[m]) * members[m].duration_s;
  }
  return glm::length(travel) / duration_s;
}

// Index of the sample at these weights; neighbouring simplices share equal samples.
uint16_t findSample(ParameterSpace& space, ParameterSample sample) {
  for (size_t s = 0; s < space.samples.size(); ++s) {
    double distance = 0;
    for (size_t m = 0; m < sample.weights.size(); ++m)
      distance += std::abs(sample.weights[m] - space.samples[s].weights[m]);
    if (distance < 1e-6) return uint16_t(s);
  }
  space.samples.push_back(std::move(sample));
  return uint16_t(space.samples.size() - 1);
}

void addCells(ParameterSpace& space, const std::vector<uint16_t>& grid, bool interval, int steps) {
  size_t row = 0;  // first sample in row y of the grid
  for (int y = 0; y < steps; ++y) {
    const int length = interval ? 1 : steps - y + 1;
    const size_t next = row + size_t(length);
    if (interval) space.simplices.push_back({grid[row], grid[next], grid[next]});
    for (int z = 0; z + 1 < length; ++z) {
      const size_t i = row + size_t(z), j = next + size_t(z);
      space.simplices.push_back({grid[i], grid[j], grid[i + 1]});
      if (z + 2 < length) space.simplices.push_back({grid[j], grid[j + 1], grid[i + 1]});
    }
    row = next;
  }
}

}  // namespace

double speedOf(const Member& member) { return glm::length(glm::dvec2(member.travel)) / member.duration_s; }

HybridMix mixOf(const BlendSimplex& simplex) {
  return simplex.interval() ? HybridMix::Polynomial : HybridMix::Straight;
}

Result<std::vector<BlendSimplex>> classSimplices(const std::vector<Member>& members, const std::string& place) {
  std::vector<BlendSimplex> simplices;
  if (members[0].parameter.size() == 1) {
    std::vector<int> order(members.size());
    std::iota(order.begin(), order.end(), 0);
    const auto value = [&](int m) { return members[size_t(m)].parameter[0]; };
    std::sort(order.begin(), order.end(), [&](int a, int b) { return value(a) < value(b); });
    for (size_t i = 0; i + 1 < order.size(); ++i) {
      const int a = order[i], b = order[i + 1];
      if (value(b) - value(a) < 1e-6 * std::max(1.0, std::abs(value(b))))
        return impossible(place, "'" + members[size_t(a)].name + "' and '" + members[size_t(b)].name +
                                     "' have the same parameter; leave one out");
      simplices.push_back({{a, b, b}});
    }
    return simplices;
  }
  if (members.size() < 3) return impossible(place, "two parameters need three or four members");
  const std::vector<glm::dvec2> points = scaledPoints(members);
  simplices = members.size() == 3 ? std::vector<BlendSimplex>{{{0, 1, 2}}} : quadTriangles(points);
  for (const BlendSimplex& s : simplices) {
    const glm::dvec2 a = points[size_t(s.members[0])];
    if (std::abs(cross(points[size_t(s.members[1])] - a, points[size_t(s.members[2])] - a)) < 1e-3)
      return impossible(place, "members' parameters lie on a line; give it one parameter, or leave one member out");
  }
  return simplices;
}

ParameterSpace parameterTable(const std::vector<Member>& members, const std::vector<std::string>& names,
                              const std::vector<bool>& measured, const std::vector<HybridSimplex>& simplices,
                              size_t reference_count) {
  ParameterSpace space;
  space.names = names;
  for (const HybridSimplex& simplex : simplices) {
    const bool interval = simplex.corners.interval();
    const int steps = interval ? kIntervalSteps : kTriangleSteps;
    std::vector<uint16_t> grid;
    for (const Shares& shares : simplexGrid(interval, steps)) {
      ParameterSample sample;
      sample.weights = simplexWeights(simplex.corners, shares, members.size());
      for (size_t p = 0; p < names.size(); ++p) {
        double value = 0;
        for (size_t m = 0; m < members.size(); ++m) value += double(sample.weights[m]) * members[m].parameter[p];
        sample.at.push_back(measured[p] ? mixedSpeed(members, sample.weights) : value);
      }
      sample.offsets.resize(reference_count);
      const auto mixed = hybridCoefficients(simplex.nodes, simplex.segments, mixOf(simplex.corners), shares);
      for (size_t n = 0; n < mixed.size(); ++n) sample.offsets[simplex.references[n]] = float(mixed[n]);
      grid.push_back(findSample(space, std::move(sample)));
    }
    addCells(space, grid, interval, steps);
  }
  return space;
}

}  // namespace fourdvt::bake
