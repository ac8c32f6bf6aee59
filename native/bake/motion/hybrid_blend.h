// SPDX-License-Identifier: Apache-2.0
// Selects the weights of a class at which corrections towards the non-linear blend are stored, interpolates between
// them, and measures the residual error (algorithms/motion.md). The weights lie on simplices of members: intervals
// (one parameter) or triangles (two).
//
// An interval of `segments` n interpolates n − 1 references by the polynomial through them and both ends, which needs
// fewer references than piecewise linear interpolation; they lie where the polynomial's error is smallest. A triangle
// has its references on the grid of n-ths and interpolates them linearly, so that neighbouring triangles are
// continuous.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bake/motion/class_plan.h"

namespace fourdvt::bake {

struct BlendSimplex {
  std::array<int, 3> members{};  // last two of an interval are equal
  bool interval() const { return members[1] == members[2]; }
};
using Shares = glm::dvec3;  // weights of a simplex's corners, sum 1; third weight of an interval: 0

std::vector<float> simplexWeights(const BlendSimplex& simplex, const Shares& shares, size_t member_count);
// All points of a simplex's grid of `segments`-ths, corners included.
std::vector<Shares> simplexGrid(bool interval, int segments);

enum class HybridMix { Straight, Polynomial };
// References of a simplex. Nodes of a polynomial are Chebyshev's points, stretched so that the outermost two are the
// ends: of all nodes that include both ends, these minimise the maximum product of the distances to all nodes, and
// with it the bound on the polynomial's error. An interval's are rounded to the grid of `check_segments`-ths.
std::vector<Shares> hybridNodes(bool interval, int segments, int check_segments, HybridMix mix);
// Coefficient of every node at a point.
std::vector<double> hybridCoefficients(std::span<const Shares> nodes, int segments, HybridMix mix, const Shares& at);

// Residual errors by number of segments, measured in one pass over the phases.
class HybridErrors {
 public:
  struct Error {
    double max_m = 0, sum_squares = 0;
    uint64_t count = 0;
  };
  HybridErrors(const BlendSimplex& simplex, HybridMix mix, int check_segments, int max_segments);
  // Adds one phase. `members`: positions of all members of the class.
  void add(const NonlinearBlend& blend, std::span<const Positions> members);
  const Error& of(int segments) const { return levels_[size_t(segments - 1)].error; }  // 1: the linear blend
  int maxSegments() const { return int(levels_.size()); }

 private:
  struct Level {
    std::vector<size_t> nodes;                     // points_ indices
    std::vector<std::vector<float>> coefficients;  // [point][node]
    Error error;
  };
  BlendSimplex simplex_;
  std::vector<Shares> points_;
  std::vector<Level> levels_;  // [segments - 1]
};

// Tabulates the weights of a class by the value of its parameters (package::ParameterSpace). "2.1 m/s" is the speed
// that results from blended travel and blended duration, not a blend of speeds.

// A simplex with its selected references.
struct HybridSimplex {
  BlendSimplex corners;
  int segments = 1;
  std::vector<Shares> nodes;
  std::vector<size_t> references;  // [node] index in ClassPlan::reference_weights
};

// Simplices of members by Member::parameter: intervals between neighbours, or triangles. place: "capture.json: class
// 'x'", for messages. Errors: CaptureJson (members with equal or collinear parameters).
Result<std::vector<BlendSimplex>> classSimplices(const std::vector<package::Member>& members, const std::string& place);

HybridMix mixOf(const BlendSimplex& simplex);
// measured: [parameter] true for a speed that follows from travel and duration; other values blend linearly.
package::ParameterSpace parameterTable(const std::vector<package::Member>& members,
                                       const std::vector<std::string>& names, const std::vector<bool>& measured,
                                       const std::vector<HybridSimplex>& simplices, size_t reference_count);

double speedOf(const package::Member& member);  // mean speed of a whole pass, m/s

}  // namespace fourdvt::bake
