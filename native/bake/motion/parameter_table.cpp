// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/parameter_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fourdvt::bake {
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
  std::array<int, 4> order = {0, 1, 2, 3};  // members in order round their middle
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

// The sample at these weights; neighbouring simplices share equal samples.
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
