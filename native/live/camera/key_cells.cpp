// SPDX-License-Identifier: Apache-2.0
#include "live/camera/key_cells.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::live {
namespace {

constexpr int kOutlineReach_px = 4;    // margin around differing cells in which pixels are compared
constexpr float kStrong = 2;           // multiple of the threshold that at least one cell of a part must exceed
constexpr float kNoiseMargin = 3.5f;   // ratio of threshold to median difference
constexpr float kMaxNoise = 3;         // median difference in tolerances above which the performer fills the picture
constexpr float kMinPart = 1.0f / 30;  // minimum size of a part, relative to the largest part
constexpr int kTinyHole_px2 = 24;      // maximum area of holes that are always closed
constexpr float kDoubtfulHole = 0.7f;  // multiple of the threshold: holes that differ more from the plate are closed
constexpr int kBlock = 4;              // cells along a block, over which the background's gain is averaged

constexpr float kPlain = 1000;  // sum of levels that pulls a gain to 1 far from the background

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

void sumSquares(const Image& rgb, const Image& plate, int cell_px, CellSquares& out) {
  const int columns = (rgb.width + cell_px - 1) / cell_px, rows = (rgb.height + cell_px - 1) / cell_px;
  out.own.resize(size_t(columns) * rows);
  out.with_plate.resize(size_t(columns) * rows);
  const size_t values = size_t(rgb.width) * 3;
  std::vector<uint16_t> own(values), with_plate(values);
  for (int cy = 0; cy < rows; ++cy) {
    std::fill(own.begin(), own.end(), uint16_t(0));
    std::fill(with_plate.begin(), with_plate.end(), uint16_t(0));
    for (int y = cy * cell_px; y < std::min(rgb.height, (cy + 1) * cell_px); ++y) {
      const uint8_t *a = rgb.at(0, y), *b = plate.at(0, y);
      uint16_t *aa = own.data(), *ab = with_plate.data();
      for (size_t i = 0; i < values; ++i) {  // quarters: four rows of them fit 16 bits
        aa[i] = uint16_t(aa[i] + (uint16_t(a[i] * a[i]) >> 2));
        ab[i] = uint16_t(ab[i] + (uint16_t(a[i] * b[i]) >> 2));
      }
    }
    for (int cx = 0; cx < columns; ++cx) {
      const size_t first = size_t(cx) * cell_px * 3, end = std::min(values, first + size_t(cell_px) * 3);
      int sum_own = 0, sum_with = 0;
      for (size_t i = first; i < end; ++i) sum_own += own[i], sum_with += with_plate[i];
      out.own[size_t(cy) * columns + cx] = 4.0f * float(sum_own);
      out.with_plate[size_t(cy) * columns + cx] = 4.0f * float(sum_with);
    }
  }
}

CellKey::CellKey(CellModel model, int cell_px) : model_(std::move(model)), cell_px_(cell_px) {
  reduceToCells(model_.plate, cell_px, plate_);
  sumSquares(model_.plate, model_.plate, cell_px, plate_squares_);
  width_ = plate_.width;
  height_ = plate_.height;
  const size_t cells = size_t(width_) * height_;
  difference_.resize(cells);
  shade_.resize(cells);
  out_.kind.resize(cells);
  block_columns_ = (width_ + kBlock - 1) / kBlock;
  block_rows_ = (height_ + kBlock - 1) / kBlock;
}

// Computes differences from the plate under the shade that fits the luma best, clamped to a shadow's limits: of cell
// means here, of pixels in textureDifferences(), since a shadow preserves the background's texture.
void CellKey::differences() {
  const float *mr = plate_.channel[0].data(), *mg = plate_.channel[1].data(), *mb = plate_.channel[2].data(),
              *r = means_.channel[0].data(), *g = means_.channel[1].data(), *b = means_.channel[2].data(),
              *tolerance = model_.tolerance.data();
  const float least = model_.min_shade, most = model_.max_shade;
  float *out = difference_.data(), *shades = shade_.data();
  for (size_t i = 0; i < difference_.size(); ++i) {
    const float luma = 0.25f * r[i] + 0.5f * g[i] + 0.25f * b[i] + 1;
    const float plate = 0.25f * mr[i] + 0.5f * mg[i] + 0.25f * mb[i] + 1;
    const float shade = std::min(most, std::max(least, luma / plate));
    const float dr = r[i] - shade * mr[i], dg = g[i] - shade * mg[i], db = b[i] - shade * mb[i];
    shades[i] = shade;
    out[i] = std::sqrt(dr * dr + dg * dg + db * db) / tolerance[i];
  }
}

void CellKey::textureDifferences() {
  const float *texture = model_.texture_tolerance.data(), *own = squares_.own.data(),
              *with_plate = squares_.with_plate.data(), *plates = plate_squares_.own.data(), *shade = shade_.data();
  const float share = 1.0f / float(cell_px_ * cell_px_);
  float* out = difference_.data();
  for (size_t i = 0; i < difference_.size(); ++i) {
    const float pixels2 = share * std::max(0.0f, own[i] - shade[i] * (2 * with_plate[i] - shade[i] * plates[i]));
    out[i] = std::max(out[i], std::sqrt(pixels2) / texture[i]);
  }
}

float CellKey::medianDifference() const {
  constexpr int kBins = 64;
  int counts[kBins] = {};
  for (const float d : difference_) ++counts[std::min(kBins - 1, int(d * (kBins / kMaxNoise)))];
  size_t below = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    below += size_t(counts[bin]);
    if (2 * below >= difference_.size()) return float(bin + 1) * kMaxNoise / kBins;
  }
  return kMaxNoise;
}

// Dilates or erodes a mask by a square; the border is replicated.
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

// Visits the connected parts of evidence_ within the box that have `value`, each as the list part_: 8-connected for the
// performer, 4-connected for the background.
template <class Visit>
void CellKey::eachPart(uint8_t value, const Box& box, const Visit& visit) {
  seen_.assign(evidence_.size(), 0);
  const auto reach = [&](int x, int y) {
    const uint32_t at = uint32_t(y * width_ + x);
    if (x < box.x0 || y < box.y0 || x >= box.x1 || y >= box.y1 || seen_[at] || evidence_[at] != value) return;
    seen_[at] = 1;
    stack_.push_back(at);
  };
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) {
      reach(x, y);
      if (stack_.empty()) continue;
      part_.clear();
      while (!stack_.empty()) {
        const uint32_t at = stack_.back();
        stack_.pop_back();
        part_.push_back(at);
        const int ax = int(at) % width_, ay = int(at) / width_;
        reach(ax - 1, ay), reach(ax + 1, ay), reach(ax, ay - 1), reach(ax, ay + 1);
        if (value == 0) continue;
        reach(ax - 1, ay - 1), reach(ax + 1, ay - 1), reach(ax - 1, ay + 1), reach(ax + 1, ay + 1);
      }
      visit();
    }
}

CellKey::Box CellKey::boxOfEvidence() const {
  Box box{width_, height_, 0, 0};
  for (int y = 0; y < height_; ++y) {
    const uint8_t* row = &evidence_[size_t(y) * width_];
    for (int x = 0; x < width_; ++x) {
      if (!row[x]) continue;
      box.x0 = std::min(box.x0, x), box.x1 = std::max(box.x1, x + 1);
      box.y0 = std::min(box.y0, y), box.y1 = y + 1;
    }
  }
  return box;
}

// Keeps parts that have a strong cell and are not specks compared with the largest.
void CellKey::keepParts(float threshold) {
  size_t largest = 0;
  const auto strong = [&] {
    return std::any_of(part_.begin(), part_.end(), [&](uint32_t i) { return difference_[i] > kStrong * threshold; });
  };
  const auto clear = [&] {
    for (const uint32_t i : part_) evidence_[i] = 0;
  };
  const Box box = boxOfEvidence();
  eachPart(1, box, [&] { strong() ? void(largest = std::max(largest, part_.size())) : clear(); });
  const auto least = std::max(size_t(16 / (cell_px_ * cell_px_)) + 2, size_t(kMinPart * float(largest)));
  eachPart(1, box, [&] {
    if (part_.size() < least) clear();
  });
}

void CellKey::fillHoles(float threshold) {
  const auto tiny = std::max<size_t>(1, size_t(kTinyHole_px2 / (cell_px_ * cell_px_)));
  const Box box = boxOfEvidence();
  eachPart(0, box, [&] {
    float sum = 0;
    for (const uint32_t i : part_) {
      const int x = int(i) % width_, y = int(i) / width_;
      if (x == box.x0 || y == box.y0 || x == box.x1 - 1 || y == box.y1 - 1) return;  // open region, not a hole
      sum += difference_[i];
    }
    if (part_.size() > tiny && sum < kDoubtfulHole * threshold * float(part_.size())) return;
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
  spread(mask_, 1, false);
  for (size_t i = 0; i < whole_.size(); ++i)
    out_.kind[i] = mask_[i] ? CellKind::Performer : whole_[i] ? CellKind::Outline : CellKind::Background;
}

// Convolves with [1 2 1] along both axes, twice; zero beyond the border.
void CellKey::smooth(std::vector<float>& blocks) {
  scratch_.resize(blocks.size());
  const auto along = [](const std::vector<float>& in, std::vector<float>& out, int count, int lines, int step,
                        int line_step) {
    for (int line = 0; line < lines; ++line)
      for (int i = 0; i < count; ++i) {
        const int at = line * line_step + i * step;
        out[size_t(at)] =
            2 * in[size_t(at)] + (i > 0 ? in[size_t(at - step)] : 0) + (i + 1 < count ? in[size_t(at + step)] : 0);
      }
  };
  for (int round = 0; round < 2; ++round) {
    along(blocks, scratch_, block_columns_, block_rows_, 1, block_columns_);
    along(scratch_, blocks, block_rows_, block_columns_, block_columns_, 1);
  }
}

// Sums the background's cells block by block and diffuses the sums into blocks that the performer covers.
void CellKey::gains() {
  mask_ = whole_;
  spread(mask_, 1, true);
  for (int c = 0; c < 3; ++c) {
    auto &now = block_now_[size_t(c)], &plate = block_plate_[size_t(c)];
    now.assign(size_t(block_columns_) * block_rows_, 0);
    plate.assign(now.size(), 0);
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const size_t cell = size_t(y) * width_ + x, block = size_t(y / kBlock) * block_columns_ + x / kBlock;
        if (mask_[cell]) continue;
        now[block] += means_.channel[c][cell];
        plate[block] += plate_.channel[c][cell];
      }
    smooth(now);
    smooth(plate);
  }
}

std::array<float, 3> CellKey::gainAt(int x, int y) const {
  const float bx = std::clamp((float(x) + 0.5f) / kBlock - 0.5f, 0.0f, float(block_columns_ - 1)),
              by = std::clamp((float(y) + 0.5f) / kBlock - 0.5f, 0.0f, float(block_rows_ - 1));
  const int x0 = int(bx), y0 = int(by), x1 = std::min(x0 + 1, block_columns_ - 1),
            y1 = std::min(y0 + 1, block_rows_ - 1);
  const float fx = bx - float(x0), fy = by - float(y0);
  const auto sample = [&](const std::vector<float>& of) {
    const auto row = [&](int at) {
      const size_t first = size_t(at) * block_columns_;
      return (1 - fx) * of[first + x0] + fx * of[first + x1];
    };
    return (1 - fy) * row(y0) + fy * row(y1);
  };
  std::array<float, 3> gain;
  for (size_t c = 0; c < 3; ++c)
    gain[c] = std::clamp((sample(block_now_[c]) + kPlain) / (sample(block_plate_[c]) + kPlain), model_.min_shade,
                         model_.max_shade);
  return gain;
}

uint8_t CellKey::plainDifference(size_t cell, const std::array<float, 3>& gain) const {
  float sum = 0;
  for (int c = 0; c < 3; ++c) {
    const float d = means_.channel[c][cell] - gain[size_t(c)] * plate_.channel[c][cell];
    sum += d * d;
  }
  return uint8_t(std::min(255.0f, std::sqrt(sum)));
}

const Cells& CellKey::key(const Image& rgb) {
  reduceToCells(rgb, cell_px_, means_);
  differences();
  if (!model_.texture_tolerance.empty()) {
    sumSquares(rgb, model_.plate, cell_px_, squares_);
    textureDifferences();
  }
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
