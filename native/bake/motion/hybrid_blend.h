// SPDX-License-Identifier: Apache-2.0
// Decides at which weights of a class corrections towards the non-linear blend are stored, how they mix, and what error
// they leave (algorithms/motion.md). The weights lie on simplices of members: intervals (one parameter) or triangles
// (two).
//
// An interval of `segments` n mixes n − 1 references by the polynomial through them and both ends, which needs fewer
// than straight pieces do; they lie where such polynomials stray least. A triangle has its references on the grid of
// n-ths and mixes them by straight pieces, so that neighbours fit together.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bake/motion/class_plan.h"

namespace fourdvt::bake {

struct BlendSimplex {
  std::array<int, 3> members{};  // an interval's last two are equal
  bool interval() const { return members[1] == members[2]; }
};
using Shares = glm::dvec3;  // weights of a simplex's corners, sum 1; the third one of an interval is 0

std::vector<float> simplexWeights(const BlendSimplex& simplex, const Shares& shares, size_t member_count);
// All points of a simplex's grid of `segments`-ths, corners included.
std::vector<Shares> simplexGrid(bool interval, int segments);

enum class HybridMix { Straight, Polynomial };
// The references of a simplex. Those that a polynomial mixes are Chebyshev's points, stretched so that the outermost
// two are the ends: of all nodes that include both ends, these keep the product of the distances to all nodes smallest,
// and with it the bound on a polynomial's error. An interval's are rounded to the grid of `check_segments`-ths.
std::vector<Shares> hybridNodes(bool interval, int segments, int check_segments, HybridMix mix);
// Coefficient of every node at a point.
std::vector<double> hybridCoefficients(std::span<const Shares> nodes, int segments, HybridMix mix, const Shares& at);

// The errors that every number of segments leaves, measured in one pass over the phases.
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

// Tabulates which weights a class needs for a parameter's value (package::ParameterSpace). "2.1 m/s" is the speed that
// the mixed travel and the mixed duration give, not a mix of speeds.

// A simplex with the references chosen for it.
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
// measured: [parameter] true for a speed that follows from travel and duration; other values mix linearly.
package::ParameterSpace parameterTable(const std::vector<package::Member>& members,
                                       const std::vector<std::string>& names, const std::vector<bool>& measured,
                                       const std::vector<HybridSimplex>& simplices, size_t reference_count);

double speedOf(const package::Member& member);  // mean speed of a whole pass, m/s

}  // namespace fourdvt::bake
