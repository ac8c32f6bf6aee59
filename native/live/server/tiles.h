// SPDX-License-Identifier: Apache-2.0
// Places where each camera's crop lies in the packed picture, whose size never changes. A layout holds from key to key: what
// leaves its source meanwhile is missing, until a new layout is wanted. Does NOT draw.
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

// share: texels of the layout against the cameras' pixels. Errors: InvalidArgument (sides beyond kMaxPictureSide).
Result<PackedSize> packedSize(std::span<const PinholeCamera> cameras, double share);

// Pixels of the camera's picture that the points fall into, without margin; no width: none.
package::Rect projectedBox(const PinholeCamera& camera, const Positions& positions);
// The box with a margin of this share of its longer side and some pixels, on even pixels, within `limits`.
package::Rect padded(const package::Rect& box, double share, int pixels, const package::Rect& limits);
package::Rect common(const package::Rect& a, const package::Rect& b);  // no width: none

class LiveTiles {
 public:
  LiveTiles(std::vector<PinholeCamera> cameras, const PackedSize& size) : cameras_(std::move(cameras)), size_(size) {}
  // boxes: projectedBox of each camera; crops: of the pictures that came; no width: none. True: some of the performer
  // lies outside of its source by more than a margin though the crop shows it, or a camera has no tile yet.
  bool wantsLayout(std::span<const package::Rect> boxes, std::span<const package::Rect> crops) const;
  // Cameras without box or crop get no tile. Sources are drawn as large as they are if all fit, else smaller alike.
  void plan(std::span<const package::Rect> boxes, std::span<const package::Rect> crops);
  const std::vector<package::CameraTile>& tiles() const { return tiles_; }
  double scale() const { return scale_; }  // texels per pixel of the layout

 private:
  bool place(std::vector<package::CameraTile>& tiles) const;

  std::vector<PinholeCamera> cameras_;
  PackedSize size_;
  std::vector<package::CameraTile> tiles_;
  double scale_ = 1;
};

}  // namespace fourdvt::live
