// SPDX-License-Identifier: Apache-2.0
// Compares a surface with its silhouettes: overlap, outline distance and pictures.
#pragma once

#include "silhouette/silhouette.h"

namespace fourdvt::reconstruct {

// Intersection over union of the drawn surface and the silhouette, both at 2 × 2 samples per pixel; the silhouette is
// thresholded at coverage 127.5. 1 if both are empty.
double silhouetteOverlap(const silhouette::Silhouette& silhouette, const TriangleMesh& surface);

// Overlap, and the median distance of the silhouette's outline from the surface's, pixels; NaN if either has none.
struct SilhouetteMatch {
  double overlap = 1, outline_px = 0;
};
SilhouetteMatch silhouetteMatch(const silhouette::Silhouette& silhouette, const TriangleMesh& surface);

// Share of the hull's picture where the surface lies at least `min_m` behind the hull along the optical axis, or is
// missing.
double movedShare(const PinholeCamera& camera, const TriangleMesh& hull, const TriangleMesh& surface, double min_m);

// RGB, cropped to the performer: the camera's picture with the outlines of surface (green) and silhouette (red) where
// they differ; and the surface alone, shaded from the camera.
struct SurfacePictures {
  Image over_picture, shaded;
};
// Picture of the same crop: the surface from grey at the hull to red at `max_m` or more behind it.
Image movedPicture(const PinholeCamera& camera, const Image& rgba, const TriangleMesh& hull,
                   const TriangleMesh& surface, double max_m);
SurfacePictures surfacePictures(const silhouette::Silhouette& silhouette, const Image& rgba,
                                const TriangleMesh& surface);

}  // namespace fourdvt::reconstruct
