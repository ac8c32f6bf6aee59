// SPDX-License-Identifier: Apache-2.0
#include "refine/surface_fit.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "base/robust.h"

namespace fourdvt::refine {
namespace {

constexpr int kReweightings = 6;
using SparseMatrix = Eigen::SparseMatrix<double>;

}  // namespace

OffsetClaim claimOf(const OutlinePoint& s) {
  return {s.from, s.to, s.to_share, s.residual_pixels / s.pixels_per_metre};
}

std::vector<float> fitOffsets(std::span<const OffsetClaim> claims, std::span<const InnerEdge> edges,
                              std::span<const float> current, std::span<const Clearance> clearances,
                              const SurfaceFitOptions& options) {
  const Eigen::Index count = Eigen::Index(current.size());
  Eigen::VectorXd offset(count);
  for (Eigen::Index v = 0; v < count; ++v) offset[v] = current[size_t(v)];
  if (claims.empty()) return {current.begin(), current.end()};
  // What each claim asks of its edge in all: what the edge lacks, and the offset that it has already.
  std::vector<double> wanted(claims.size());
  for (size_t i = 0; i < claims.size(); ++i) {
    const OffsetClaim& c = claims[i];
    wanted[i] = c.offset_m + (1 - c.to_share) * offset[c.from] + c.to_share * offset[c.to];
  }
  Eigen::SimplicialLDLT<SparseMatrix> solver;
  std::vector<double> misfit(claims.size());
  for (int round = 0; round < kReweightings; ++round) {
    for (size_t i = 0; i < claims.size(); ++i) {
      const OffsetClaim& c = claims[i];
      misfit[i] = wanted[i] - (1 - c.to_share) * offset[c.from] - c.to_share * offset[c.to];
    }
    const double scale = std::max(1e-5, robustScale(misfit));
    const double usual = options.keep_at_median ? quantile(wanted, 0.5) : 0;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    const auto add = [&](uint32_t a, uint32_t b, double value) { entries.emplace_back(int(a), int(b), value); };
    for (Eigen::Index v = 0; v < count; ++v)
      entries.emplace_back(int(v), int(v), options.keep), right[v] += options.keep * usual;
    for (const InnerEdge& e : edges) {
      add(e.from, e.from, options.stiffness);
      add(e.to, e.to, options.stiffness);
      add(e.from, e.to, -options.stiffness);
      add(e.to, e.from, -options.stiffness);
    }
    for (size_t i = 0; i < claims.size(); ++i) {
      const OffsetClaim& c = claims[i];
      const double w = tukeyWeight(misfit[i] / scale);
      const double a = 1 - c.to_share, b = c.to_share;
      add(c.from, c.from, w * a * a);
      add(c.to, c.to, w * b * b);
      add(c.from, c.to, w * a * b);
      add(c.to, c.from, w * a * b);
      right[c.from] += w * a * wanted[i];
      right[c.to] += w * b * wanted[i];
    }
    SparseMatrix matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (round == 0) solver.analyzePattern(matrix);
    solver.factorize(matrix);
    offset = solver.solve(right);
  }
  std::vector<float> out(current.size());
  for (size_t v = 0; v < out.size(); ++v)
    out[v] = float(std::clamp(offset[Eigen::Index(v)], -options.bound_m, options.bound_m));
  keepClear(clearances, out);
  return out;
}

}  // namespace fourdvt::refine
