// SPDX-License-Identifier: Apache-2.0
// Bounds the hull inside the band of a plane sweep by the cameras' mattes, so that empty space costs nothing.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"

namespace fourdvt::reconstruct {

constexpr int kSweepCell = 4;  // pixels along each side

// Numbers of pixels of a matte that are not background, for boxes of a picture.
class MatteCounts {
 public:
  // Pixels with alpha below `background` are background.
  MatteCounts(const Image& rgba, uint8_t background);
  // True if the whole box of positions is in the picture, a pixel's half from its border, and matte values interpolated
  // there have only background around them; positions may err by a pixel.
  bool onlyBackground(const glm::dvec2& low, const glm::dvec2& high) const;

 private:
  size_t index(int x, int y) const { return size_t(y) * (width_ + 1) + x; }
  int width_, height_;
  std::vector<uint32_t> counts_;  // sums over the pixels above and left of each pixel corner
};

struct SweptCamera {
  glm::dmat4 pixel_from_reference{1.0};  // from (x z, y z, z, 1) of the reference to (pixel times depth, depth)
  const MatteCounts* matte = nullptr;
};

// Cells of kSweepCell × kSweepCell pixels and one block of four planes: 0 where a camera sees all points of the cell
// before its background, or where there is no front; else 255. Block above block, rows and columns of cells from the
// region's top left. `first_plane`: of each pixel's first block, negative without front; planes lie at multiples of
// `step_m`.
std::vector<uint8_t> openCells(std::span<const SweptCamera> cameras, const PictureRegion& region,
                               std::span<const int> first_plane, int blocks, double step_m);

}  // namespace fourdvt::reconstruct
