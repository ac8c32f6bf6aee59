// SPDX-License-Identifier: Apache-2.0
// How positions are predicted, for the encoder and the decoder alike. Exact definition: FORMAT.md, "Positions". The
// prediction uses IEEE double additions, subtractions, multiplications and divisions in the order written; files that
// include this must not contract them (-ffp-contract=off). Internal to package/.
#pragma once

#include <algorithm>
#include <cmath>

#include "package/binary_coder.h"
#include "package/chunk_mesh.h"

namespace fourdvt::package {

constexpr int32_t kMaxQuantised = 1 << 24;  // |q| of a position

// What a local affine motion, fitted to the vertices that are known already, does to one more vertex.
class MotionFit {
 public:
  explicit MotionFit(const glm::dvec3& centre) : centre_(centre) {}
  // A vertex's reference position and its displacement.
  void add(const glm::dvec3& reference, const glm::dvec3& displacement, double weight) {
    offsets_[count_] = reference - centre_;
    displacements_[count_] = displacement;
    weights_[count_] = weight;
    ++count_;
  }
  // Displacement at the centre; ridge regression, so that it is defined for any set of vertices.
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
  // -(M + ridge I)^-1 offset, M the weighted scatter of the offsets around their mean.
  glm::dvec3 gradientWeights(const glm::dvec3& offset) const {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    for (int i = 0; i < count_; ++i) {
      const glm::dvec3 d = offsets_[i] - offset, w = weights_[i] * d;
      xx = xx + w.x * d.x, xy = xy + w.x * d.y, xz = xz + w.x * d.z;
      yy = yy + w.y * d.y, yz = yz + w.y * d.z, zz = zz + w.z * d.z;
    }
    const double ridge = 0.003 * (xx + yy + zz) + 1;
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
  std::array<glm::dvec3, 24> offsets_, displacements_;
  std::array<double, 24> weights_;
};

template <class Coder>
class PositionModel {
 public:
  // base_scale: steps of the stream per 65536 lattice units of the base pose.
  PositionModel(Coder& coder, const ChunkMesh& mesh, uint32_t base_scale)
      : coder_(coder),
        mesh_(mesh),
        size_bits_(2 * 64 * 32),
        mantissa_bits_(32 * 8),
        magnitudes_(mesh.vertexCount(), glm::ivec3(0)),
        magnitudes_before_(magnitudes_) {
    for (const glm::ivec3& q : mesh.base) reference_.push_back(glm::dvec3(q) * (base_scale / 65536.0));
  }

  // Frames in order. positions: [vertex], read by an encoder, written by a decoder. False: a position out of range.
  bool frame(glm::ivec3* positions) {
    std::swap(magnitudes_, magnitudes_before_);
    for (uint32_t v = 0; v < mesh_.vertexCount(); ++v) {
      const glm::ivec3 predicted = predict(positions, v);
      positions[v] = predicted + codeResidual(v, positions[v] - predicted);
      for (int k = 0; k < 3; ++k) {
        if (positions[v][k] < -kMaxQuantised || positions[v][k] > kMaxQuantised) return false;
      }
    }
    for (uint32_t v = 0; v < mesh_.vertexCount(); ++v) reference_[v] = glm::dvec3(positions[v]);
    temporal_ = true;
    return true;
  }

 private:
  static constexpr int kMaxMagnitude = 1 << 14, kMaxSize = 26;

  glm::ivec3 predict(const glm::ivec3* positions, uint32_t v) const {
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

  // About 1.5 log2: 0, 1 → 0; 2 → 1; 3 → 1; 4, 5 …
  static uint32_t level(int magnitude) {
    uint32_t level = 0;
    for (; magnitude >= 2 && level < 31; ++level) magnitude = magnitude * 5 >> 3;
    return level;
  }

  glm::ivec3 codeResidual(uint32_t v, const glm::ivec3& residual) {
    const auto ring = mesh_.earlierOf(v).first(mesh_.ring_count[v]);
    glm::ivec3 sum(0);
    for (uint32_t u : ring) sum += magnitudes_[u];
    const int n = static_cast<int>(ring.size());
    const glm::ivec3 near = n ? sum * 8 / n : glm::ivec3(16);
    const int near_mean = (near.x + near.y + near.z) / 3;
    const glm::ivec3& then = magnitudes_before_[v];
    const int then_mean = temporal_ ? (then.x + then.y + then.z) * 8 / 3 : near_mean;
    glm::ivec3 out(0);
    int coded = 0;
    for (int k = 0; k < 3; ++k) {
      const int whole = (near_mean * 2 + then_mean + (k ? coded * 8 / k : near_mean)) / 4;
      const int own = (near[k] * 2 + (temporal_ ? then[k] * 8 : near[k])) / 3;
      out[k] = codeValue(residual[k], temporal_ * 32 + level(whole), temporal_ * 32 + level(own));
      magnitudes_[v][k] = std::min(std::abs(out[k]), kMaxMagnitude);
      coded += magnitudes_[v][k];
    }
    return out;
  }

  // Number of binary digits of |value| in unary, the digits below the leading one, the sign.
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

  static constexpr uint32_t kLimit = 60;
  Coder& coder_;
  const ChunkMesh& mesh_;
  bool temporal_ = false;  // false in a chunk's first frame
  std::vector<AdaptiveBit> size_bits_, mantissa_bits_;
  std::vector<glm::ivec3> magnitudes_, magnitudes_before_;  // of the residuals, this frame and the one before
  std::vector<glm::dvec3> reference_;                       // the frame before, or the base pose
};

}  // namespace fourdvt::package
