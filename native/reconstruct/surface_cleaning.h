// SPDX-License-Identifier: Apache-2.0
// Removes specks, phantoms, hollows and unseen components of a hull, fairs its surface and simplifies it. Connected
// parts stay whole.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "base/camera.h"
#include "base/mesh.h"
#include "reconstruct/carve.h"
#include "silhouette/silhouette.h"

namespace fourdvt::reconstruct {
constexpr double kSpeckVoxels = 27;  // maximum size of grid noise

// Removes specks: components below a thousandth of the largest one's volume, or below `min_volume_m3`. Hollows have
// negative volume; its absolute value counts. Returns the number of removed components.
size_t dropSpecks(TriangleMesh& mesh, double min_volume_m3);

// Removes specks, and phantoms: components that in every camera's picture are covered by larger ones over at least nine
// tenths of their area, so that no silhouette requires them.
size_t dropNeedless(TriangleMesh& mesh, std::span<const silhouette::Silhouette* const> silhouettes,
                    double min_volume_m3);

// Removes components with fewer than half of their vertices in the pictures of at least `min_cameras`, since unseen
// space is not carved. Returns the number of removed components, possibly all.
size_t dropUnseen(TriangleMesh& mesh, std::span<const PinholeCamera> cameras, size_t min_cameras);

// Removes hollows, which no camera sees.
size_t dropHollows(TriangleMesh& mesh);

// Smooths the ridges that cones leave on a hull (future work in Li et al. 2003, section 6), within the silhouettes:
// vertices leave them by at most a quarter of a pixel. Keeps the topology. Runs up to `rounds` rounds, each half of the
// way to the neighbours' mean. `still_good` is called after every round and returns false if a silhouette is no longer
// covered; that round is undone. This bounds the shrinkage of thin parts; a volume-preserving filter would push ridges
// outwards again. Returns the number of rounds kept.
int fairSurface(TriangleMesh& mesh, std::span<const CarvingView> views, int rounds,
                const std::function<bool(const TriangleMesh&)>& still_good);

// Simplifies a surface by edge collapses (meshoptimizer) to at most `max_faces`, where the topology permits; smaller
// meshes are unchanged. Keeps the topology and the positions of remaining vertices. Faces may cross.
void simplify(TriangleMesh& mesh, size_t max_faces);

}  // namespace fourdvt::reconstruct
