// SPDX-License-Identifier: Apache-2.0
#include "live/camera/key_cells.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::live {
namespace {

constexpr int kOutlineReach_px = 4;   // of the pixels that are looked at, on both sides of the cells' outline
constexpr float kStrong = 2;          // times the threshold: one such cell at least makes a part
constexpr float kNoiseMargin = 3.5f;  // threshold over the median difference
constexpr float kMostNoise = 3;       // median difference in tolerances, beyond which the performer fills the picture
constexpr float kLeastPart = 1.0f / 30;  // of the largest part
constexpr float kHoleShare = 3e-4f;      // of the picture: smaller holes are closed
constexpr float kDoubtfulHole = 0.5f;    // of the threshold: holes that differ so much from the plate are closed
constexpr int kGainReach = 3;            // cells over which the background's gain is averaged, twice

// Running sums along a line of `count` values, `step` apart: out = Σ of in over ±reach.
void boxSum(const float* in, float* out, int count, int step, int reach) {
  float sum = 0;
  for (int i = 0; i < std::min(reach, count); ++i) sum += in[ptrdiff_t(i) * step];
  for (int i = 0; i < count; ++i) {
    if (i + reach < count) sum += in[ptrdiff_t(i + reach) * step];
    if (i > reach) sum -= in[ptrdiff_t(i - reach - 1) * step];
    out[ptrdiff_t(i) * step] = sum;
  }
}

void boxSum(std::vector<float>& values, std::vector<float>& scratch, int width, int height, int reach) {
  scratch.resize(values.size());
  for (int y = 0; y < height; ++y) boxSum(&values[size_t(y) * width], &scratch[size_t(y) * width], width, 1, reach);
  for (int x = 0; x < width; ++x) boxSum(&scratch[x], &values[x], height, width, reach);
}

}  // namespace

int cellSideFor(int width, int height) { return std::max(width, height) <= 400 ? 2 : 4; }

void reduceToCells(const Image& rgb, int cell_px, CellMeans& out) {
  out.width = (rgb.width + cell_px - 1) / cell_px;
  out.height = (rgb.height + cell_px - 1) / cell_px;
  for (auto& c : out.channel) c.resize(size_t(out.width) * out.height);
  std::vector<uint16_t> column(size_t(rgb.width) * 3);
  for (int cy = 0; cy < out.height; ++cy) {
    const int rows = std::min(cell_px, rgb.height - cy * cell_px);
    std::fill(column.begin(), column.end(), uint16_t(0));
    for (int y = 0; y < rows; ++y) {
      const uint8_t* row = rgb.at(0, cy * cell_px + y);
      uint16_t* sums = column.data();
      for (size_t i = 0; i < column.size(); ++i) sums[i] = uint16_t(sums[i] + row[i]);
    }
    const size_t first = size_t(cy) * out.width;
    for (int cx = 0; cx < out.width; ++cx) {
      const int columns = std::min(cell_px, rgb.width - cx * cell_px);
      const uint16_t* sums = &column[size_t(cx) * cell_px * 3];
      int r = 0, g = 0, b = 0;
      for (int x = 0; x < columns; ++x, sums += 3) r += sums[0], g += sums[1], b += sums[2];
      const float share = 1.0f / float(rows * columns);
      out.channel[0][first + cx] = float(r) * share;
      out.channel[1][first + cx] = float(g) * share;
      out.channel[2][first + cx] = float(b) * share;
    }
  }
}

CellKey::CellKey(CellModel model, int cell_px)
    : model_(std::move(model)), cell_px_(cell_px), width_(model_.mean.width), height_(model_.mean.height) {
  const size_t cells = size_t(width_) * height_;
  difference_.resize(cells);
  out_.kind.resize(cells);
  for (auto& g : out_.gain) g.resize(cells);
}

// The difference from the plate under the shade that suits the luma best, within a shadow's limits.
void CellKey::differences() {
  const float *mr = model_.mean.channel[0].data(), *mg = model_.mean.channel[1].data(),
              *mb = model_.mean.channel[2].data(), *r = means_.channel[0].data(), *g = means_.channel[1].data(),
              *b = means_.channel[2].data(), *tolerance = model_.tolerance.data();
  const float least = model_.least_shade, most = model_.most_shade;
  float* out = difference_.data();
  for (size_t i = 0; i < difference_.size(); ++i) {
    const float luma = 0.25f * r[i] + 0.5f * g[i] + 0.25f * b[i] + 1;
    const float plate = 0.25f * mr[i] + 0.5f * mg[i] + 0.25f * mb[i] + 1;
    const float shade = std::min(most, std::max(least, luma / plate));
    const float dr = r[i] - shade * mr[i], dg = g[i] - shade * mg[i], db = b[i] - shade * mb[i];
    out[i] = std::sqrt(dr * dr + dg * dg + db * db) / tolerance[i];
  }
}

float CellKey::medianDifference() const {
  constexpr int kBins = 64;
  int counts[kBins] = {};
  for (const float d : difference_) ++counts[std::min(kBins - 1, int(d * (kBins / kMostNoise)))];
  size_t below = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    below += size_t(counts[bin]);
    if (2 * below >= difference_.size()) return float(bin + 1) * kMostNoise / kBins;
  }
  return kMostNoise;
}

// Grows a mask by a square, or shrinks it; beyond the picture lies more of the same.
void CellKey::spread(std::vector<uint8_t>& mask, int radius, bool grow) {
  row_.resize(mask.size());
  const auto take = [grow](uint8_t a, uint8_t b) { return uint8_t(grow ? a | b : a & b); };
  for (int round = 0; round < radius; ++round) {
    for (int y = 0; y < height_; ++y) {
      const uint8_t* in = &mask[size_t(y) * width_];
      uint8_t* out = &row_[size_t(y) * width_];
      for (int x = 1; x + 1 < width_; ++x) out[x] = take(in[x], take(in[x - 1], in[x + 1]));
      out[0] = take(in[0], in[std::min(1, width_ - 1)]);
      out[width_ - 1] = take(in[width_ - 1], in[std::max(0, width_ - 2)]);
    }
    for (int y = 0; y < height_; ++y) {
      const uint8_t *at = &row_[size_t(y) * width_], *above = y > 0 ? at - width_ : at,
                    *below = y + 1 < height_ ? at + width_ : at;
      uint8_t* out = &mask[size_t(y) * width_];
      for (int x = 0; x < width_; ++x) out[x] = take(at[x], take(above[x], below[x]));
    }
  }
}

// Visits the connected parts of evidence_ that have `value`, each as the list part_: the performer's by eight
// neighbours, background by four.
template <class Visit>
void CellKey::eachPart(uint8_t value, const Visit& visit) {
  seen_.assign(evidence_.size(), 0);
  for (uint32_t start = 0; start < evidence_.size(); ++start) {
    if (evidence_[start] != value || seen_[start]) continue;
    part_.clear();
    stack_.assign(1, start);
    seen_[start] = 1;
    while (!stack_.empty()) {
      const uint32_t at = stack_.back();
      stack_.pop_back();
      part_.push_back(at);
      const int x = int(at) % width_, y = int(at) / width_;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (value == 0 && dx != 0 && dy != 0) continue;
          if (x + dx < 0 || y + dy < 0 || x + dx >= width_ || y + dy >= height_) continue;
          const uint32_t next = uint32_t(int(at) + dy * width_ + dx);
          if (seen_[next] || evidence_[next] != value) continue;
          seen_[next] = 1;
          stack_.push_back(next);
        }
    }
    visit();
  }
}

// Leaves parts that have a strong cell and are not specks beside the largest.
void CellKey::keepParts(float threshold) {
  size_t largest = 0;
  const auto strong = [&] {
    return std::any_of(part_.begin(), part_.end(), [&](uint32_t i) { return difference_[i] > kStrong * threshold; });
  };
  const auto clear = [&] {
    for (const uint32_t i : part_) evidence_[i] = 0;
  };
  eachPart(1, [&] { strong() ? void(largest = std::max(largest, part_.size())) : clear(); });
  const auto least = std::max(size_t(16 / (cell_px_ * cell_px_)) + 2, size_t(kLeastPart * float(largest)));
  eachPart(1, [&] {
    if (part_.size() < least) clear();
  });
}

void CellKey::fillHoles(float threshold) {
  const auto least = std::max<size_t>(2, size_t(kHoleShare * float(evidence_.size())));
  eachPart(0, [&] {
    float sum = 0;
    for (const uint32_t i : part_) {
      const int x = int(i) % width_, y = int(i) / width_;
      if (x == 0 || y == 0 || x == width_ - 1 || y == height_ - 1) return;
      sum += difference_[i];
    }
    if (part_.size() > least && sum < kDoubtfulHole * threshold * float(part_.size())) return;
    for (const uint32_t i : part_) evidence_[i] = 1;
  });
}

void CellKey::sortCells() {
  const int reach = std::max(1, kOutlineReach_px / cell_px_);
  whole_ = evidence_;
  spread(whole_, 1, true);  // closes gaps
  spread(whole_, 1, false);
  spread(whole_, reach, true);
  mask_ = evidence_;
  spread(mask_, reach, false);
  for (size_t i = 0; i < whole_.size(); ++i)
    out_.kind[i] = mask_[i] ? CellKind::Performer : whole_[i] ? CellKind::Outline : CellKind::Background;
}

void CellKey::gains() {
  const size_t cells = whole_.size();
  mask_ = whole_;
  spread(mask_, 1, true);
  weight_.resize(cells);
  for (size_t i = 0; i < cells; ++i) weight_[i] = mask_[i] ? 0.0f : 1.0f;
  constexpr float kPlain = 1e-3f;  // weight of a gain of 1, where nothing else is near
  for (int c = 0; c < 3; ++c) {
    const float *mean = model_.mean.channel[c].data(), *now = means_.channel[c].data();
    float* gain = out_.gain[c].data();
    for (size_t i = 0; i < cells; ++i)
      gain[i] = weight_[i] * std::min(model_.most_shade, std::max(model_.least_shade, (now[i] + 4) / (mean[i] + 4)));
    for (int round = 0; round < 2; ++round) boxSum(out_.gain[c], sum_, width_, height_, kGainReach);
  }
  for (int round = 0; round < 2; ++round) boxSum(weight_, sum_, width_, height_, kGainReach);
  for (auto& channel : out_.gain)
    for (size_t i = 0; i < cells; ++i) channel[i] = (channel[i] + kPlain) / (weight_[i] + kPlain);
}

uint8_t CellKey::plainDifference(size_t cell) const {
  float sum = 0;
  for (int c = 0; c < 3; ++c) {
    const float d = means_.channel[c][cell] - out_.gain[c][cell] * model_.mean.channel[c][cell];
    sum += d * d;
  }
  return uint8_t(std::min(255.0f, std::sqrt(sum)));
}

const Cells& CellKey::key(const Image& rgb) {
  reduceToCells(rgb, cell_px_, means_);
  differences();
  const float threshold = out_.threshold = std::max(1.0f, kNoiseMargin * medianDifference());
  evidence_.resize(difference_.size());
  for (size_t i = 0; i < difference_.size(); ++i) evidence_[i] = difference_[i] > threshold;
  keepParts(threshold);
  fillHoles(threshold);
  out_.any = std::find(evidence_.begin(), evidence_.end(), 1) != evidence_.end();
  if (!out_.any) return out_;
  sortCells();
  gains();
  return out_;
}

}  // namespace fourdvt::live
