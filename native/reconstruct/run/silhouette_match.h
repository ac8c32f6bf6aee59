// SPDX-License-Identifier: Apache-2.0
// A surface against the silhouettes that it was made from: how much they overlap, and both as a picture.
#pragma once

#include "reconstruct/silhouette.h"

namespace fourdvt::reconstruct {

// Intersection over union of the drawn surface and the silhouette, both at 2 × 2 samples a pixel, the silhouette cut at
// coverage 127.5. 1 if both are empty.
double silhouetteOverlap(const Silhouette& silhouette, const TriangleMesh& surface);

// RGB, cropped to the performer: the camera's picture with the surface's outline in green and the silhouette's in red
// where they are apart; and the surface alone, shaded as from the camera.
struct SurfacePictures {
  Image over_picture, shaded;
};
SurfacePictures surfacePictures(const Silhouette& silhouette, const Image& rgba, const TriangleMesh& surface);

}  // namespace fourdvt::reconstruct
