// SPDX-License-Identifier: Apache-2.0
// Layout of the cameras' crops in the packed picture, whose size is constant. A layout holds from key to key: parts
// that leave their source are missing until a new layout is requested.
#pragma once

#include <span>
#include <vector>

#include "base/camera.h"
#include "base/mesh.h"
#include "base/result.h"
#include "package/surface_chunk.h"

namespace fourdvt::live {

struct PackedSize {
  int width = 0, height = 0;  // whole picture, texels; multiples of 16
  package::Rect tiles;        // the layout, at (0, 0); the barcode lies below
  package::BarcodeStrip barcode;
};

// share: texels of the layout over the cameras' pixels. Errors: InvalidArgument (sides above kMaxPictureSide).
Result<PackedSize> packedSize(std::span<const PinholeCamera> cameras, double share);

// Bounding box of the projected points, pixels, clipped to the picture; no width: none is visible.
package::Rect projectedBox(const PinholeCamera& camera, const Positions& positions);
// Box enlarged by this share of its longer side plus `pixels`, on even pixels, clipped to `limits`.
package::Rect padded(const package::Rect& box, double share, int pixels, const package::Rect& limits);
package::Rect common(const package::Rect& a, const package::Rect& b);  // intersection; no width: empty

class LiveTiles {
 public:
  LiveTiles(std::vector<PinholeCamera> cameras, const PackedSize& size) : cameras_(std::move(cameras)), size_(size) {}
  // boxes: projectedBox of each camera; crops: of the received pictures; no width: none. True if the performer exceeds
  // its source by more than a margin within the crop, or if a camera has no tile yet.
  bool wantsLayout(std::span<const package::Rect> boxes, std::span<const package::Rect> crops) const;
  // Plans a new layout. Cameras without box or crop get no tile. Sources keep their size if all fit, else share one
  // scale.
  void plan(std::span<const package::Rect> boxes, std::span<const package::Rect> crops);
  const std::vector<package::CameraTile>& tiles() const { return tiles_; }
  double scale() const { return scale_; }  // texels of the layout per source pixel

 private:
  bool place(std::vector<package::CameraTile>& tiles) const;

  std::vector<PinholeCamera> cameras_;
  PackedSize size_;
  std::vector<package::CameraTile> tiles_;
  double scale_ = 1;
};

}  // namespace fourdvt::live
