// SPDX-License-Identifier: Apache-2.0
// Draws cameras' pictures into the packed picture: the performer inside of his outline, and round him his colours
// smoothed, then grey, which cost a codec nothing. Does NOT choose tiles.
#pragma once

#include <vector>

#include "base/image.h"
#include "live/server/jpeg_planes.h"
#include "live/server/ring_coverage.h"
#include "live/server/tiles.h"

namespace fourdvt::live {

class TilePainter {
 public:
  explicit TilePainter(const PackedSize& size);
  void clear();  // grey all over: for another layout
  // planes: what the camera shows of `crop`; of the source beyond it nothing is known. BT.601 full → BT.709 limited.
  void draw(const package::CameraTile& tile, const JpegPlanes& planes, const package::Rect& crop,
            const std::vector<Ring16>& rings);
  void drawBarcode(uint32_t number);
  I420View view() const;

 private:
  struct Plane {
    int width = 0, height = 0;
    std::vector<uint8_t> texels;
    uint8_t* row(int y) { return &texels[size_t(y) * width]; }
  };
  struct Block {  // colours × weight; weight 0…1
    float y = 0, u = 0, v = 0, weight = 0;
  };
  struct Blocks {
    int width = 0, height = 0;
    std::vector<Block> at;
  };

  void fetch(const package::CameraTile& tile, const JpegPlanes& planes, const package::Rect& crop);
  void convert();
  void fill();
  void gather(Blocks& blocks) const;
  void fillPlane(const Blocks& blocks, float Block::*channel, int step, Plane& plane);

  const PackedSize size_;
  std::vector<uint8_t> luma_, blue_, red_;  // of the packed picture
  RingCoverage coverage_;
  Plane y_, u_, v_, known_;  // of the tile's cells; known: 255 performer, 0 to be filled
  std::vector<uint8_t> smooth_, small_;
};

}  // namespace fourdvt::live
