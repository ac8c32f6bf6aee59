// SPDX-License-Identifier: Apache-2.0
// The coarse half of the live key: a picture reduced to cells, and for each cell whether it is surely background,
// surely performer, or near the outline. Does NOT look at single pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"

namespace fourdvt::live {

// Means of square blocks of pixels; those at the right and at the bottom may be smaller.
struct CellMeans {
  int width = 0, height = 0;      // cells
  std::vector<float> channel[3];  // [cell] R, G, B, levels of 255
};

int cellSideFor(int width, int height);  // pixels
void reduceToCells(const Image& rgb, int cell_px, CellMeans& out);

struct CellModel {
  CellMeans mean;                // of the plates
  std::vector<float> tolerance;  // [cell] levels by which background may differ
  float least_shade = 0.55f;     // of a shadow, against the plate, in encoded values
  float most_shade = 1.2f;
};

enum class CellKind : uint8_t { Background, Outline, Performer };

struct Cells {
  std::vector<CellKind> kind;
  std::vector<float> gain[3];  // [cell] of the background beside the performer against the plates: shadows, drift
  float threshold = 1;         // tolerances beyond which a cell is the performer's: more in a noisy picture
  bool any = false;            // there is a performer
};

class CellKey {
 public:
  CellKey(CellModel model, int cell_px);
  const Cells& key(const Image& rgb);
  const CellModel& model() const { return model_; }
  // Levels between a cell of the last picture and the plate under the cell's gain, up to 255.
  uint8_t plainDifference(size_t cell) const;

 private:
  void differences();
  float medianDifference() const;
  void spread(std::vector<uint8_t>& mask, int radius, bool grow);
  void keepParts(float threshold);
  void fillHoles(float threshold);
  void sortCells();
  void gains();
  template <class Visit>
  void eachPart(uint8_t value, const Visit& visit);

  CellModel model_;
  int cell_px_, width_, height_;
  CellMeans means_;
  std::vector<float> difference_;                              // in tolerances
  std::vector<uint8_t> evidence_, whole_, seen_, row_, mask_;  // masks of cells; scratch
  std::vector<uint32_t> stack_, part_;
  std::vector<float> weight_, sum_;
  Cells out_;
};

}  // namespace fourdvt::live
