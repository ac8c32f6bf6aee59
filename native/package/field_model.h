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
  // components: 2 or 3 per vector.
  FieldModel(Coder& coder, const ChunkMesh& mesh, int components)
      : mesh_(mesh), residuals_(coder, mesh, components), before_(mesh.vertexCount(), glm::ivec3(0)), now_(before_) {}

  // Codes one frame; frames come in order. values: [vertex], read by an encoder, written by a decoder. False: value out
  // of range.
  template <int N>
  bool frame(glm::vec<N, int>* values) {
    return frame(values, [&](uint32_t v, const glm::ivec3& predicted) {
      glm::ivec3 wanted(0);
      for (int k = 0; k < N; ++k) wanted[k] = values[v][k];
      return wanted - predicted;
    });
  }
  // residualOf(vertex, prediction): residual to code; unused in a decoder.
  template <int N, class ResidualOf>
  bool frame(glm::vec<N, int>* values, const ResidualOf& residualOf) {
    std::swap(before_, now_);
    residuals_.beginFrame();
    for (uint32_t v = 0; v < mesh_.vertexCount(); ++v) {
      const glm::ivec3 predicted = predict(v);
      now_[v] = predicted + residuals_.code(v, residualOf(v, predicted));
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
  ResidualModel<Coder> residuals_;
  std::vector<glm::ivec3> before_, now_;
};

}  // namespace fourdvt::package
