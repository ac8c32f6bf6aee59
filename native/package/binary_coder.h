// SPDX-License-Identifier: Apache-2.0
// Adaptive binary arithmetic coding in integers: identical bits on every machine. Exact definition: FORMAT.md, "The bit
// coder".
// A model is a template over BinaryEncoder / BinaryDecoder, so that both sides run the same code; code() takes the bit
// to write (ignored by the decoder) and returns the bit.
// Model functions that run per vertex or face are [[gnu::flatten]]: a size-optimised wasm build would not inline their
// arithmetic otherwise. Internal to package/.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fourdvt::package {

class BinaryEncoder {
 public:
  // p_one: probability of a 1 in 1/65536, in [1, 65535].
  bool code(bool bit, uint32_t p_one) {
    const uint32_t middle = low_ + static_cast<uint32_t>((static_cast<uint64_t>(high_ - low_) * p_one) >> 16);
    if (bit)
      high_ = middle;
    else
      low_ = middle + 1;
    for (; (low_ ^ high_) < (1u << 24); low_ <<= 8, high_ = high_ << 8 | 255) out_.push_back(low_ >> 24);
    return bit;
  }
  std::vector<uint8_t> take() {
    for (int shift = 24; shift >= 0; shift -= 8) out_.push_back(static_cast<uint8_t>(low_ >> shift));
    return std::move(out_);
  }

 private:
  std::vector<uint8_t> out_;
  uint32_t low_ = 0, high_ = UINT32_MAX;
};

class BinaryDecoder {
 public:
  explicit BinaryDecoder(std::span<const uint8_t> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | next();
  }
  bool code(bool, uint32_t p_one) {
    const uint32_t middle = low_ + static_cast<uint32_t>((static_cast<uint64_t>(high_ - low_) * p_one) >> 16);
    const bool bit = value_ <= middle;
    if (bit)
      high_ = middle;
    else
      low_ = middle + 1;
    for (; (low_ ^ high_) < (1u << 24); low_ <<= 8, high_ = high_ << 8 | 255) value_ = value_ << 8 | next();
    return bit;
  }
  bool overrun() const { return position_ > bytes_.size(); }
  // True at the end of an intact stream: every byte read, none missing.
  bool finished() const { return position_ == bytes_.size(); }

 private:
  uint32_t next() {
    const size_t at = position_++;
    return at < bytes_.size() ? bytes_[at] : 0;
  }
  std::span<const uint8_t> bytes_;
  size_t position_ = 0;
  uint32_t low_ = 0, high_ = UINT32_MAX, value_ = 0;
};

// Probability of a 1 (22 bits) and its number of updates (10 bits).
class AdaptiveBit {
 public:
  uint32_t p16() const { return state_ >> 16; }
  uint32_t p12() const { return state_ >> 20; }
  // Moves the probability towards `bit` by the share 1 / (n + 1.5); n: number of updates, at most `limit`.
  void update(bool bit, uint32_t limit) {
    const uint32_t n = state_ & 1023, rate = 131072 / (2 * n + 3);
    const int64_t p = state_ >> 10, moved = p + ((((bit ? 4194303 : 0) - p) * rate) >> 16);
    state_ = static_cast<uint32_t>(moved << 10 | (n < limit ? n + 1 : n));
  }

 private:
  uint32_t state_ = 1u << 31;
};

// Logistic function and its inverse ln(p / (1 - p)), in 1/128.
class Logistic {
 public:
  static constexpr int kMax = 1407;
  Logistic() {
    for (int p = 0, x = -kMax; p < 4096; ++p) {
      while (x < kMax && squash(x) < 16 * p + 8) ++x;
      stretch_[p] = static_cast<int16_t>(x);
    }
  }
  int stretch(uint32_t p12) const { return stretch_[p12]; }
  // Piecewise linear between kKnots, which are 65536 / (1 + exp(-x / 128)) at x = -1408, -1344 … 0.
  static int squash(int x) {
    if (x > 0) return 65536 - squash(-x);
    x = (x < -kMax ? -kMax : x) + 1408;
    const int i = x >> 6, part = x & 63;
    return i == 22 ? kKnots[22] : (kKnots[i] * (64 - part) + kKnots[i + 1] * part) >> 6;
  }

 private:
  static constexpr int kKnots[23] = {1,   2,   3,    5,    8,    13,   22,   36,    60,    98,    162,  267,
                                     439, 720, 1179, 1921, 3108, 4971, 7812, 11955, 17625, 24743, 32768};
  std::array<int16_t, 4096> stretch_;
};

// Predicts a bit from N contexts: mixes their probabilities in the logistic domain with learned weights.
template <int N>
class MixedBit {
 public:
  MixedBit(int table_bits, uint32_t weight_sets)
      : mask_((1u << table_bits) - 1),
        table_(size_t(1) << table_bits),
        weights_(size_t(weight_sets) * N, kFirstWeight) {}

  template <class Coder>
  bool code(Coder& coder, bool bit, const std::array<uint32_t, N>& contexts, uint32_t weight_set) {
    std::array<AdaptiveBit*, N> bits;
    std::array<int, N> inputs;
    int32_t* weights = &weights_[size_t(weight_set) * N];
    int64_t sum = 0;
    for (int i = 0; i < N; ++i) {
      bits[i] = &table_[hash(contexts[i], static_cast<uint32_t>(i)) & mask_];
      inputs[i] = logistic_.stretch(bits[i]->p12());
      sum += int64_t(weights[i]) * inputs[i];
    }
    sum >>= 16;
    const int x = sum > Logistic::kMax ? Logistic::kMax : sum < -Logistic::kMax ? -Logistic::kMax : int(sum);
    const int squashed = Logistic::squash(x), p = squashed < 4 ? 4 : squashed > 65532 ? 65532 : squashed;
    bit = coder.code(bit, static_cast<uint32_t>(p));
    const int64_t error = (bit ? 65536 : 0) - p;
    for (int i = 0; i < N; ++i) {
      const int64_t moved = weights[i] + ((inputs[i] * error * kRate) >> 14);
      weights[i] = static_cast<int32_t>(moved > kMaxWeight ? kMaxWeight : moved < -kMaxWeight ? -kMaxWeight : moved);
      bits[i]->update(bit, kLimit);
    }
    return bit;
  }

 private:
  static constexpr int32_t kFirstWeight = 26214, kMaxWeight = 1 << 20;
  static constexpr int kRate = 2;
  static constexpr uint32_t kLimit = 250;
  static uint32_t hash(uint32_t context, uint32_t i) {
    uint32_t h = (context + (i + 1) * 0x9E3779B1u) * 0x85EBCA6Bu;
    h = (h ^ h >> 15) * 0xC2B2AE35u;
    return h ^ h >> 16;
  }
  uint32_t mask_;
  std::vector<AdaptiveBit> table_;
  std::vector<int32_t> weights_;
  Logistic logistic_;
};

}  // namespace fourdvt::package
