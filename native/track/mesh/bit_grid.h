// SPDX-License-Identifier: Apache-2.0
// A square grid of free and occupied cells, and masks that are placed in it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace fourdvt::track {

// The cells of a shape. Order of calls: set, then finish, then the rest.
class Mask {
 public:
  struct Run {
    int y, first, last;  // cells `first` to `last`
  };
  Mask(int width, int height)
      : width_(std::max(1, width)), height_(std::max(1, height)), cells_(size_t(width_) * size_t(height_), 0) {}
  void set(int x, int y) { cells_[size_t(y) * size_t(width_) + size_t(x)] = 1; }
  void finish() {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        if (!cells_[size_t(y) * size_t(width_) + size_t(x)]) continue;
        if (runs_.empty() || runs_.back().y != y || runs_.back().last != x - 1) runs_.push_back({y, x, x});
        runs_.back().last = x;
      }
    cells_ = {};
    std::stable_sort(runs_.begin(), runs_.end(),
                     [](const Run& a, const Run& b) { return a.last - a.first > b.last - b.first; });
  }
  int width() const { return width_; }
  int height() const { return height_; }
  const std::vector<Run>& runs() const { return runs_; }  // the longest first

 private:
  int width_, height_;
  std::vector<uint8_t> cells_;
  std::vector<Run> runs_;
};

class BitGrid {
 public:
  explicit BitGrid(int side) : side_(side), words_((side + 63) / 64) {
    while (1 << levels_ <= side_) ++levels_;
    bits_.assign(size_t(side_) * size_t(levels_) * size_t(words_), 0);
  }

  // First place with free cells, by rows; empty where there is none.
  std::optional<glm::ivec2> firstFree(const Mask& mask) const {
    if (mask.width() > side_ || mask.height() > side_) return std::nullopt;
    std::vector<uint64_t> blocked(static_cast<size_t>(words_));
    for (int y = 0; y + mask.height() <= side_; ++y) {
      std::fill(blocked.begin(), blocked.end(), 0);
      for (int x = side_ - mask.width() + 1; x < 64 * words_; ++x) blocked[size_t(x / 64)] |= uint64_t(1) << (x % 64);
      if (const int x = firstFreeInRow(mask, y, blocked); x >= 0) return glm::ivec2(x, y);
    }
    return std::nullopt;
  }

  void occupy(const Mask& mask, const glm::ivec2& at) {
    for (const Mask::Run& run : mask.runs()) {
      uint64_t* row = level(at.y + run.y, 0);
      for (int x = at.x + run.first; x <= at.x + run.last; ++x) row[x / 64] |= uint64_t(1) << (x % 64);
    }
    for (int y = at.y; y < at.y + mask.height(); ++y)
      for (int j = 1; j < levels_; ++j) {
        std::copy_n(level(y, j - 1), words_, level(y, j));
        orShifted(level(y, j - 1), 1 << (j - 1), level(y, j));
      }
  }

 private:
  // Bit x of level j: a cell of x … x + 2^j - 1 is occupied.
  uint64_t* level(int y, int j) { return bits_.data() + size_t((y * levels_ + j) * words_); }
  const uint64_t* level(int y, int j) const { return bits_.data() + size_t((y * levels_ + j) * words_); }

  // Bit x of `out` gets bit x + shift of `from`.
  void orShifted(const uint64_t* from, int shift, uint64_t* out) const {
    const int whole = shift / 64, part = shift % 64;
    for (int w = 0; w + whole < words_; ++w) {
      out[w] |= from[w + whole] >> part;
      if (part && w + whole + 1 < words_) out[w] |= from[w + whole + 1] << (64 - part);
    }
  }

  int firstFreeInRow(const Mask& mask, int y, std::vector<uint64_t>& blocked) const {
    for (const Mask::Run& run : mask.runs()) {
      int j = 0;
      while (2 << j <= run.last - run.first + 1) ++j;
      orShifted(level(y + run.y, j), run.first, blocked.data());
      orShifted(level(y + run.y, j), run.last + 1 - (1 << j), blocked.data());
      if (std::all_of(blocked.begin(), blocked.end(), [](uint64_t w) { return w == ~uint64_t(0); })) return -1;
    }
    for (int x = 0; x < side_; ++x)
      if (!(blocked[size_t(x / 64)] >> (x % 64) & 1)) return x;
    return -1;
  }

  int side_, words_, levels_ = 1;
  std::vector<uint64_t> bits_;  // [row][level][word]
};

}  // namespace fourdvt::track
