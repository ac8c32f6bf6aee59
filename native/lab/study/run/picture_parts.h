// SPDX-License-Identifier: Apache-2.0
// Parts of the sheets of study/steps/pictures.cpp.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "lab/measure/character_frame.h"
#include "lab/study/run/context.h"
#include "report/picture_sheets.h"

namespace fourdvt::study {

constexpr int kCell = 320, kBodyHeight = 520;  // pixels of a sheet's cells

// Azimuths midway between neighbouring cameras, degrees, as in OrbitView.
std::vector<double> middleAzimuths_deg(const std::vector<PinholeCamera>& cameras);
// Blend weight of layer l, from the three weights of DebugView::Weights; layer 3 takes the remainder.
std::vector<uint8_t> shareOf(const Image& shares, int layer);
// Crops a body picture to the box (x, y, width, height), scaled to fit a cell.
Image bodyCell(const Image& rgb, const std::array<int, 4>& box);
// Crops a view to its box, and adds three enlarged parts: head, trunk, legs.
std::vector<Image> viewWithCrops(const Image& picture, const std::array<int, 4>& box);
// Mean colour of the first camera's plate; nullopt if the capture has none.
std::optional<glm::dvec3> backdropColour(const capture::Capture& capture);

// Rows of table "seams": means over the pictures added, weighted by their seam samples.
class SeamTable {
 public:
  explicit SeamTable(std::optional<glm::dvec3> backdrop) : backdrop_(backdrop) {}
  // `picture`: RGBA of the camera's size.
  void add(const std::string& method, const std::string& view, const measure::CharacterFrame& frame,
           const PinholeCamera& camera, const Image& picture);
  void write(Rows& out, const std::string& sequence) const;

 private:
  struct Sums {
    double seam = 0, control = 0, fringe = 0;
    size_t samples = 0, pictures = 0;
  };
  std::optional<glm::dvec3> backdrop_;
  std::map<std::pair<std::string, std::string>, Sums> sums_;  // by method and view
};

}  // namespace fourdvt::study
