// SPDX-License-Identifier: Apache-2.0
// Predicts a field of small vectors on the surface (mesh-blend corrections, alignment) for encoder and decoder.
// Integers only. Exact definition: FORMAT.md, "Fields". Internal to package/.
#pragma once

#include <algorithm>

#include "package/residual_model.h"

namespace fourdvt::package {

template <class Coder>
class FieldModel {
 public:
  // components: 2 or 3 per vector. residual_step: see residualUnit.
  FieldModel(Coder& coder, const ChunkMesh& mesh, int components, uint32_t residual_step)
      : mesh_(mesh),
        residual_step_(residual_step),
        residuals_(coder, mesh, components),
        before_(mesh.vertexCount(), glm::ivec3(0)),
        now_(before_) {}

  // Codes one frame; frames come in order. values: [vertex]; an encoder replaces them by those that a decoder gets.
  // False: value or residual step out of range.
  template <int N>
  bool frame(glm::vec<N, int>* values) {
    if (!validResidualStep(residual_step_)) return false;
    std::swap(before_, now_);
    residuals_.beginFrame();
    for (uint32_t v : mesh_.order) {
      const glm::ivec3 predicted = predict(v);
      const int unit = residualUnit(mesh_, v, residual_step_);
      glm::ivec3 wanted(0);
      for (int k = 0; k < N; ++k) wanted[k] = values[v][k];
      const glm::ivec3 residual = quantisedResidual(wanted - predicted, unit);
      now_[v] = withResidual(predicted, residuals_.code(v, residual), unit);
      if (!inRange(now_[v])) return false;
      for (int k = 0; k < N; ++k) values[v][k] = now_[v][k];
    }
    return true;
  }

 private:
  // Vertex value in the previous frame (0 before the first) plus the mean change of its neighbours since then.
  [[gnu::flatten]] glm::ivec3 predict(uint32_t v) const {
    glm::ivec3 change(0);
    const int n = mesh_.ring_count[v];
    for (uint32_t u : mesh_.earlierOf(v).first(n)) change += now_[u] - before_[u];
    glm::ivec3 out = before_[v];
    for (int k = 0; n && k < 3; ++k) {
      out[k] += (change[k] < 0 ? change[k] - n / 2 : change[k] + n / 2) / n;
      out[k] = std::clamp(out[k], -kMaxQuantised, kMaxQuantised);
    }
    return out;
  }

  const ChunkMesh& mesh_;
  const uint32_t residual_step_;
  ResidualModel<Coder> residuals_;
  std::vector<glm::ivec3> before_, now_;
};

}  // namespace fourdvt::package
