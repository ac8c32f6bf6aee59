// SPDX-License-Identifier: Apache-2.0
// Composition of cameras' pictures into the packed picture (TilePainter), JPEG decoding for it (JpegDecoder), and the
// region that each camera transmits (CameraRegions). Tiles are chosen in tiles.h.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/result.h"
#include "live/server/live_hull.h"
#include "live/server/tiles.h"
#include "package/character.h"

namespace fourdvt::live {
// Planes of a JPEG: BT.601, full range. Chroma planes are half as large, rounded up.
struct JpegPlanes {
  int width = 0, height = 0;
  const uint8_t *y = nullptr, *u = nullptr, *v = nullptr;
  int stride_y = 0, stride_u = 0, stride_v = 0;  // bytes
};

class JpegDecoder {
 public:
  // Errors: Unsupported (this FFmpeg has no decoder).
  static Result<std::unique_ptr<JpegDecoder>> create();
  virtual ~JpegDecoder() = default;
  // Decodes a 4:2:0 JPEG without colour conversion. Valid until the next call. Errors: FileUnreadable (damaged, another
  // size, or not 4:2:0).
  virtual Result<JpegPlanes> decode(std::span<const uint8_t> jpeg, int width, int height) = 0;
};

class TilePainter {
 public:
  explicit TilePainter(const PackedSize& size);
  void clear();  // fills with grey, before a new layout
  // Draws the performer inside the outline; outside, the performer's smoothed colours fade to grey, which costs the
  // codec almost nothing. planes: the camera's picture within `crop`; texels outside `crop` are unknown. Converts
  // BT.601 full → BT.709 limited.
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
  std::vector<uint8_t> luma_, blue_, red_;  // planes of the packed picture
  RingCoverage coverage_;
  Plane y_, u_, v_, known_;  // planes of the current tile's cells; known: 255 performer, 0 to be filled
  std::vector<uint8_t> smooth_, small_;
};

// Region of its picture that each camera transmits: the performer with a margin; the whole picture while none is
// visible. Changes only when the gain justifies a message.
class CameraRegions {
 public:
  explicit CameraRegions(std::vector<PinholeCamera> cameras)
      : cameras_(std::move(cameras)), regions_(cameras_.size()) {}
  // boxes: projectedBox of each camera, without width where the hull is outside the picture; empty: no hull. Returns
  // true for each changed region.
  std::vector<bool> update(std::span<const package::Rect> boxes, int64_t now_us);
  const package::Rect& region(size_t camera) const { return regions_[camera]; }  // no width: the whole picture

 private:
  std::vector<PinholeCamera> cameras_;
  std::vector<package::Rect> regions_;
  int64_t seen_us_ = INT64_MIN;  // time of the last hull
};

}  // namespace fourdvt::live
