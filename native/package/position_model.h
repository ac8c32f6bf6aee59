// SPDX-License-Identifier: Apache-2.0
// Predicts positions, for encoder and decoder. Exact definition: FORMAT.md, "Positions". The prediction uses IEEE
// double additions, subtractions, multiplications and divisions in the order written: files that include this must not
// contract them (-ffp-contract=off). Internal to package/.
#pragma once

#include <array>
#include <cmath>

#include "package/residual_model.h"

namespace fourdvt::package {

// Fits an affine motion to the displacements of coded vertices, and applies it to one more vertex.
class MotionFit {
 public:
  explicit MotionFit(const glm::dvec3& centre) : centre_(centre) {}
  // Adds a coded vertex: reference position and displacement.
  void add(const glm::dvec3& reference, const glm::dvec3& displacement, double weight) {
    offsets_[count_] = reference - centre_;
    displacements_[count_] = displacement;
    weights_[count_] = weight;
    ++count_;
  }
  // Displacement at the centre by ridge regression: defined for any set of vertices.
  glm::dvec3 atCentre() const {
    if (count_ == 0) return glm::dvec3(0);
    double total = 0;
    glm::dvec3 offset(0), mean(0);
    for (int i = 0; i < count_; ++i) {
      total = total + weights_[i];
      offset = offset + weights_[i] * offsets_[i];
      mean = mean + weights_[i] * displacements_[i];
    }
    offset = offset / total;
    mean = mean / total;
    const glm::dvec3 g = gradientWeights(offset);
    glm::dvec3 slope(0);
    for (int i = 0; i < count_; ++i) {
      const glm::dvec3 d = offsets_[i] - offset;
      const double along = (g.x * d.x + g.y * d.y + g.z * d.z) * weights_[i];
      slope = slope + along * displacements_[i];
    }
    return mean + slope;
  }

 private:
  // -(M + ridge I)^-1 offset, M: weighted scatter of the offsets around their mean.
  glm::dvec3 gradientWeights(const glm::dvec3& offset) const {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    for (int i = 0; i < count_; ++i) {
      const glm::dvec3 d = offsets_[i] - offset, w = weights_[i] * d;
      xx = xx + w.x * d.x, xy = xy + w.x * d.y, xz = xz + w.x * d.z;
      yy = yy + w.y * d.y, yz = yz + w.y * d.z, zz = zz + w.z * d.z;
    }
    const double ridge = 0.001 * (xx + yy + zz) + 1;
    xx = xx + ridge, yy = yy + ridge, zz = zz + ridge;
    const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    const double d = xx * zz - xz * xz, e = xy * xz - xx * yz, f = xx * yy - xy * xy;
    const double determinant = xx * a + xy * b + xz * c;
    return glm::dvec3(a * offset.x + b * offset.y + c * offset.z, b * offset.x + d * offset.y + e * offset.z,
                      c * offset.x + e * offset.y + f * offset.z) /
           -determinant;
  }

  glm::dvec3 centre_;
  int count_ = 0;
  std::array<glm::dvec3, 10> offsets_, displacements_;
  std::array<double, 10> weights_;
};

// First bytes of a part of positions.
struct PositionScale {
  uint32_t base_scale = 0;     // steps of the stream per 65536 lattice units of the base pose
  uint32_t residual_step = 1;  // see residualUnit
};

template <class Coder>
class PositionModel {
 public:
  PositionModel(Coder& coder, const ChunkMesh& mesh, const PositionScale& scale)
      : mesh_(mesh), residual_step_(scale.residual_step), residuals_(coder, mesh, 3) {
    for (const glm::ivec3& q : mesh.base) reference_.push_back(glm::dvec3(q) * (scale.base_scale / 65536.0));
  }

  // Codes one frame; frames come in order. positions: [vertex]; an encoder replaces them by those that a decoder gets.
  // False: position or residual step out of range.
  bool frame(glm::ivec3* positions) {
    if (!validResidualStep(residual_step_)) return false;
    residuals_.beginFrame();
    for (uint32_t v : mesh_.order) {
      const glm::ivec3 predicted = predict(positions, v);
      const int unit = residualUnit(mesh_, v, residual_step_);
      const glm::ivec3 residual = quantisedResidual(positions[v] - predicted, unit);
      positions[v] = withResidual(predicted, residuals_.code(v, residual), unit);
      if (!inRange(positions[v])) return false;
    }
    for (uint32_t v = 0; v < mesh_.vertexCount(); ++v) reference_[v] = glm::dvec3(positions[v]);
    return true;
  }

 private:
  [[gnu::flatten]] glm::ivec3 predict(const glm::ivec3* positions, uint32_t v) const {
    MotionFit fit(reference_[v]);
    const auto earlier = mesh_.earlierOf(v);
    for (size_t i = 0; i < earlier.size(); ++i) {
      const uint32_t u = earlier[i];
      fit.add(reference_[u], glm::dvec3(positions[u]) - reference_[u], i < mesh_.ring_count[v] ? 1 : 0.25);
    }
    const glm::dvec3 p = reference_[v] + fit.atCentre();
    glm::ivec3 out(0);
    for (int k = 0; k < 3; ++k) {
      const double limit = kMaxQuantised, rounded = std::floor(p[k] + 0.5);
      out[k] = static_cast<int>(rounded > limit ? limit : rounded > -limit ? rounded : -limit);
    }
    return out;
  }

  const ChunkMesh& mesh_;
  const uint32_t residual_step_;
  ResidualModel<Coder> residuals_;
  std::vector<glm::dvec3> reference_;  // previous frame, or the base pose
};

}  // namespace fourdvt::package
