// SPDX-License-Identifier: Apache-2.0
// Coarse stage of the live key: reduces a picture to cells and classifies each as background, performer, or near the
// outline. Single pixels are compared in keyer.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/image.h"

namespace fourdvt::live {

// Means of square blocks of pixels; blocks at the right and bottom borders may be smaller.
struct CellMeans {
  int width = 0, height = 0;      // cells
  std::vector<float> channel[3];  // [cell] R, G, B, levels of 255
};

// Sums over a cell's values of all channels: squares of the picture, and products of picture and plate.
struct CellSquares {
  std::vector<float> own, with_plate;  // [cell]
};

int cellSideFor(int width, int height);  // pixels
void reduceToCells(const Image& rgb, int cell_px, CellMeans& out);
// `plate` has the size of `rgb`.
void sumSquares(const Image& rgb, const Image& plate, int cell_px, CellSquares& out);

// Background model. Levels of 255 are roots of the sum of three channels' squares.
struct CellModel {
  Image plate;                           // RGB
  std::vector<float> tolerance;          // [cell] maximum deviation of the background's mean, levels
  std::vector<float> texture_tolerance;  // [cell] maximum RMS deviation of the background's pixels, levels; empty: only
                                         // means are compared
  float min_shade = 0.55f;               // shade limits of a shadow relative to the plate, in encoded values
  float max_shade = 1.2f;
};

enum class CellKind : uint8_t { Background, Outline, Performer };

struct Cells {
  std::vector<CellKind> kind;
  float threshold = 1;  // tolerances above which a cell belongs to the performer; grows with the picture's noise
  bool any = false;     // true if a performer is visible
};

class CellKey {
 public:
  CellKey(CellModel model, int cell_px);
  const Cells& key(const Image& rgb);
  int columns() const { return width_; }
  int rows() const { return height_; }
  // Gain of the nearby background in the last picture relative to the plate, per channel: shadows, drift of the light.
  std::array<float, 3> gainAt(int x, int y) const;
  // Levels between a cell of the last picture and the plate under this gain, clamped to 255.
  uint8_t plainDifference(size_t cell, const std::array<float, 3>& gain) const;

 private:
  struct Box {  // cells, half-open
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  };

  void differences();
  void textureDifferences();
  float medianDifference() const;
  void spread(std::vector<uint8_t>& mask, int radius, bool grow);
  Box boxOfEvidence() const;
  void keepParts(float threshold);
  void fillHoles(float threshold);
  void sortCells();
  void gains();
  void smooth(std::vector<float>& blocks);
  template <class Visit>
  void eachPart(uint8_t value, const Box& box, const Visit& visit);

  CellModel model_;
  int cell_px_;
  CellMeans plate_, means_;
  int width_, height_;  // cells
  CellSquares plate_squares_, squares_;
  std::vector<float> difference_, shade_;                      // difference in tolerances; shade relative to the plate
  std::vector<uint8_t> evidence_, whole_, seen_, row_, mask_;  // cell masks; scratch
  std::vector<uint32_t> stack_, part_;
  int block_columns_, block_rows_;  // grid of gain blocks
  std::array<std::vector<float>, 3> block_now_, block_plate_;
  std::vector<float> scratch_;
  Cells out_;
};

}  // namespace fourdvt::live
