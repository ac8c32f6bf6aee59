// SPDX-License-Identifier: Apache-2.0
// Codes prediction residuals, for encoder and decoder. Contexts: magnitudes at the neighbours and in the previous
// frame. Integers only. Exact definition: FORMAT.md, "Residuals". Internal to package/.
#pragma once

#include <algorithm>
#include <cstdlib>

#include "package/binary_coder.h"
#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::package {

constexpr int32_t kMaxQuantised = 1 << 24;  // |q| of a position, an offset, a displacement

inline bool inRange(const glm::ivec3& q) {
  for (int k = 0; k < 3; ++k) {
    if (q[k] < -kMaxQuantised || q[k] > kMaxQuantised) return false;
  }
  return true;
}

inline bool validResidualStep(uint32_t step) { return step >= 1 && step <= kMaxResidualStep; }

// Unit of a vertex's residuals: a part's residual step; half of it, rounded up, for the vertices from which those of
// the last round are predicted.
inline int residualUnit(const ChunkMesh& mesh, uint32_t vertex, uint32_t step) {
  return static_cast<int>(mesh.last_round[vertex] ? step : (step + 1) / 2);
}

// Residual that an encoder writes, in units. 0 below 0.7 units, rounded down up to 0.6 above a whole number: fewer
// bytes than by rounding to the nearest. Exact with unit 1.
inline glm::ivec3 quantisedResidual(const glm::ivec3& residual, int unit) {
  if (unit == 1) return residual;
  glm::ivec3 out(0);
  for (int k = 0; k < 3; ++k) {
    const int magnitude = std::abs(residual[k]);
    if (10 * magnitude < 7 * unit) continue;
    const int whole = std::max(1, (10 * magnitude + 4 * unit) / (10 * unit));
    out[k] = residual[k] < 0 ? -whole : whole;
  }
  return out;
}

// Prediction plus a residual in units; out of range (inRange) rather than an overflow.
inline glm::ivec3 withResidual(const glm::ivec3& predicted, const glm::ivec3& residual, int unit) {
  glm::ivec3 out;
  for (int k = 0; k < 3; ++k) {
    const int64_t sum = predicted[k] + int64_t(residual[k]) * unit, limit = kMaxQuantised + 1;
    out[k] = static_cast<int>(std::clamp(sum, -limit, limit));
  }
  return out;
}

template <class Coder>
class ResidualModel {
 public:
  // components: 2 or 3 coded numbers per residual; the rest are 0.
  ResidualModel(Coder& coder, const ChunkMesh& mesh, int components)
      : coder_(coder),
        mesh_(mesh),
        components_(components),
        size_bits_(2 * 64 * 32),
        mantissa_bits_(32 * 8),
        magnitudes_(mesh.vertexCount(), glm::ivec3(0)),
        magnitudes_before_(magnitudes_) {}

  void beginFrame() {
    std::swap(magnitudes_, magnitudes_before_);
    temporal_ = started_;
    started_ = true;
  }

  // Codes the residual of one vertex; vertices come in ascending order. Magnitudes are below 2^26.
  [[gnu::flatten]] glm::ivec3 code(uint32_t v, const glm::ivec3& residual) {
    const auto ring = mesh_.earlierOf(v).first(mesh_.ring_count[v]);
    glm::ivec3 sum(0);
    for (uint32_t u : ring) sum += magnitudes_[u];
    const int n = static_cast<int>(ring.size());
    const glm::ivec3 near = n ? sum * 8 / n : glm::ivec3(16);
    const int near_mean = mean(near);
    const glm::ivec3& then = magnitudes_before_[v];
    const int then_mean = temporal_ ? mean(then * 8) : near_mean;
    glm::ivec3 out(0);
    int coded = 0;
    for (int k = 0; k < components_; ++k) {
      const int whole = (near_mean * 2 + then_mean + (k ? coded * 8 / k : near_mean)) / 4;
      const int own = (near[k] * 2 + (temporal_ ? then[k] * 8 : near[k])) / 3;
      out[k] = codeValue(residual[k], temporal_ * 32 + level(whole), temporal_ * 32 + level(own));
      magnitudes_[v][k] = std::min(std::abs(out[k]), kMaxMagnitude);
      coded += magnitudes_[v][k];
    }
    return out;
  }

 private:
  static constexpr int kMaxMagnitude = 1 << 14, kMaxSize = 26;
  static constexpr uint32_t kLimit = 60;

  int mean(const glm::ivec3& m) const { return (m.x + m.y + (components_ == 3 ? m.z : 0)) / components_; }

  // Classes of magnitude, about 1.5 log2: 0, 1 → 0; 2, 3 → 1; …
  static uint32_t level(int magnitude) {
    uint32_t level = 0;
    for (; magnitude >= 2 && level < 31; ++level) magnitude = magnitude * 5 >> 3;
    return level;
  }

  // Codes the number of binary digits of |value| in unary, then the digits below the leading one, then the sign.
  int codeValue(int value, uint32_t whole, uint32_t own) {
    const uint32_t magnitude = static_cast<uint32_t>(std::abs(value));
    int size = 0;
    while (size < kMaxSize && codeSize(magnitude >> size != 0, whole * 32 + size, own * 32 + size)) ++size;
    if (size == 0) return 0;
    uint32_t digits = 1;
    for (int i = size - 2; i >= 0; --i) {
      const bool digit = magnitude >> i & 1;
      const bool modelled = digits < 4;
      digits = digits * 2 + (modelled ? codeMantissa(digit, size * 8 + digits) : coder_.code(digit, 32768));
    }
    const int out = static_cast<int>(digits);
    return coder_.code(value < 0, 32768) ? -out : out;
  }

  bool codeSize(bool bit, uint32_t whole, uint32_t own) {
    AdaptiveBit &a = size_bits_[whole], &b = size_bits_[64 * 32 + own];
    const uint32_t p = (a.p16() + b.p16()) / 2;
    bit = coder_.code(bit, std::clamp<uint32_t>(p, 32, 65504));
    a.update(bit, kLimit);
    b.update(bit, kLimit);
    return bit;
  }

  bool codeMantissa(bool bit, uint32_t context) {
    AdaptiveBit& a = mantissa_bits_[context];
    bit = coder_.code(bit, std::clamp<uint32_t>(a.p16(), 32, 65504));
    a.update(bit, kLimit);
    return bit;
  }

  Coder& coder_;
  const ChunkMesh& mesh_;
  const int components_;
  bool started_ = false, temporal_ = false;  // temporal: after a chunk's first frame
  std::vector<AdaptiveBit> size_bits_, mantissa_bits_;
  std::vector<glm::ivec3> magnitudes_, magnitudes_before_;  // residual magnitudes of this frame and of the previous one
};

}  // namespace fourdvt::package
