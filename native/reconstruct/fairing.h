// SPDX-License-Identifier: Apache-2.0
// Smooths the ridges that cones leave on a hull, and keeps to the silhouettes: no vertex leaves them by more than a
// quarter of a pixel, and a round after which a camera would see too little is taken back. (Fairing is the future work
// of Online Accelerated Rendering of Visual Hulls in Real Scenes, section 6.) Does NOT change the topology.
#pragma once

#include <functional>
#include <span>

#include "reconstruct/carve.h"

namespace fourdvt::reconstruct {

// Up to `rounds` rounds, each half of the way to the mean of the neighbours. What keeps thin parts from shrinking is
// `still_good`, not a filter: one that preserves volume pushes ridges outwards again. `still_good` says whether the
// silhouettes are still covered well enough; it is asked after every round. Returns the number of rounds that were
// kept.
int fairSurface(TriangleMesh& mesh, std::span<const CarvingView> views, int rounds,
                const std::function<bool(const TriangleMesh&)>& still_good);

}  // namespace fourdvt::reconstruct
