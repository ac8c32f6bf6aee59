// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/volumetric_hull.h"

#include <cmath>

#include "reconstruct/components.h"
#include "reconstruct/mesh_checks.h"

namespace fourdvt::reconstruct {
namespace {

// Merged faces may cross their neighbours; then fewer are merged.
constexpr size_t kMostChecked = 500'000;
constexpr double kAdaptivityShares[] = {1, 0.25, 0};

}  // namespace

TriangleMesh solidSurface(const SparseDistance& distance, double adaptivity,
                          const std::function<void(TriangleMesh&)>& drop) {
  TriangleMesh mesh;
  for (const double share : kAdaptivityShares) {
    mesh = zeroSurface(distance, share * adaptivity);
    drop(mesh);
    if (share * adaptivity == 0) break;
    if (mesh.faces.size() > kMostChecked) continue;  // comparing all faces would take minutes
    if (checkMesh(mesh).solid()) break;
  }
  return mesh;
}

Result<VolumetricHull> volumetricHull(std::span<const CarvingView> views, const VolumetricOptions& options) {
  VolumetricHull out;
  FOURDVT_ASSIGN(out.distance, carve(views, options.voxel_m));
  std::vector<const silhouette::Silhouette*> silhouettes;
  for (const CarvingView& view : views) silhouettes.push_back(view.silhouette);
  out.mesh = solidSurface(out.distance, options.adaptivity, [&](TriangleMesh& mesh) {
    out.dropped = dropNeedless(mesh, silhouettes, kSpeckVoxels * std::pow(options.voxel_m, 3));
  });
  return out;
}

}  // namespace fourdvt::reconstruct
