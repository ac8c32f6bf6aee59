// SPDX-License-Identifier: Apache-2.0
// Which parts of a hull are performers and props, and which are specks and phantoms. Does NOT cut connected parts.
#pragma once

#include <span>

#include "base/camera.h"
#include "base/mesh.h"
#include "silhouette/silhouette.h"

namespace fourdvt::reconstruct {

constexpr double kSpeckVoxels = 27;  // no larger: noise of the grid that a surface was made with

// Leaves out specks: components below a thousandth of the largest one's volume, or below `least_volume_m3`. Hollows,
// whose volume is negative, are judged by its size. Returns the number of components that were left out.
size_t dropSpecks(TriangleMesh& mesh, double least_volume_m3);

// Leaves out specks, and phantoms: components that in every camera lie behind or before larger ones, for at least nine
// tenths of their picture, so that no silhouette needs them.
size_t dropNeedless(TriangleMesh& mesh, std::span<const silhouette::Silhouette* const> silhouettes,
                    double least_volume_m3);

// Leaves out components of which fewer than half of the vertices fall into the pictures of at least `least_cameras`:
// nothing carves there. Returns the number of components that were left out, which may be all.
size_t dropUnseen(TriangleMesh& mesh, std::span<const PinholeCamera> cameras, size_t least_cameras);

// Leaves out hollows: no camera sees into them.
size_t dropHollows(TriangleMesh& mesh);

}  // namespace fourdvt::reconstruct
