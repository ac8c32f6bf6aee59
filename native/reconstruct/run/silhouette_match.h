// SPDX-License-Identifier: Apache-2.0
// A surface against the silhouettes that it was made from: how much they overlap, and both as a picture.
#pragma once

#include "silhouette/silhouette.h"

namespace fourdvt::reconstruct {

// Intersection over union of the drawn surface and the silhouette, both at 2 × 2 samples a pixel, the silhouette cut at
// coverage 127.5. 1 if both are empty.
double silhouetteOverlap(const silhouette::Silhouette& silhouette, const TriangleMesh& surface);

// The same, and the median distance of the silhouette's outline from the surface's, pixels; NaN if either has none.
struct SilhouetteMatch {
  double overlap = 1, outline_px = 0;
};
SilhouetteMatch silhouetteMatch(const silhouette::Silhouette& silhouette, const TriangleMesh& surface);

// Share of the camera's picture of the hull where the surface inside it lies deeper by `least_m` or more, along the
// optical axis, or is gone.
double movedShare(const PinholeCamera& camera, const TriangleMesh& hull, const TriangleMesh& surface, double least_m);

// RGB, cropped to the performer: the camera's picture with the surface's outline in green and the silhouette's in red
// where they are apart; and the surface alone, shaded as from the camera.
struct SurfacePictures {
  Image over_picture, shaded;
};
// Pictures as large as those: the surface alone, from grey where it is the hull to red where it lies `most_m` deeper
// and more.
Image movedPicture(const PinholeCamera& camera, const Image& rgba, const TriangleMesh& hull,
                   const TriangleMesh& surface, double most_m);
SurfacePictures surfacePictures(const silhouette::Silhouette& silhouette, const Image& rgba,
                                const TriangleMesh& surface);

}  // namespace fourdvt::reconstruct
