// SPDX-License-Identifier: Apache-2.0
// Which parts of a hull are performers and props, and which are specks and phantoms. Does NOT cut connected parts.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "base/camera.h"
#include "base/mesh.h"
#include "reconstruct/carve.h"
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

// Smooths the ridges that cones leave on a hull, and keeps to the silhouettes: no vertex leaves them by more than a
// quarter of a pixel, and a round after which a camera would see too little is taken back. (Fairing is the future work
// of Online Accelerated Rendering of Visual Hulls in Real Scenes, section 6.) Does NOT change the topology.

// Up to `rounds` rounds, each half of the way to the mean of the neighbours. What keeps thin parts from shrinking is
// `still_good`, not a filter: one that preserves volume pushes ridges outwards again. `still_good` says whether the
// silhouettes are still covered well enough; it is asked after every round. Returns the number of rounds that were
// kept.
int fairSurface(TriangleMesh& mesh, std::span<const CarvingView> views, int rounds,
                const std::function<bool(const TriangleMesh&)>& still_good);

// Fewer faces for a surface, by edge collapses (meshoptimizer). Does NOT change its topology, nor keep faces from
// crossing.

// At most `most_faces`, where the topology allows it; no change if there are no more already. Vertices in use keep
// their places.
void simplify(TriangleMesh& mesh, size_t most_faces);

}  // namespace fourdvt::reconstruct
