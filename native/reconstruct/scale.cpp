// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/scale.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "reconstruct/surface_cleaning.h"

namespace fourdvt::reconstruct {
namespace {

constexpr int kCellsAlong = 48;                // first, coarse bounds
constexpr double kVoxelsAlong = 96;            // measuring carve
constexpr int kFinerTries = 3;                 // halvings of the voxel for thin performers that fall between voxels
constexpr double kPersonThickness_m = 0.1228;  // hull of a person
constexpr double kFacesPerVoxel = 3;           // surface nets: 1.5 vertices, so 3 faces, per voxel face of area
constexpr double kSpareFaces = 4;              // maximum ratio of extracted to kept faces

// Signed volume, its centroid, and area.
struct Solid {
  double volume_m3 = 0, area_m2 = 0;
  glm::dvec3 centre{0};
};

Solid solidOf(const TriangleMesh& mesh) {
  Solid out;
  const glm::dvec3 near(mesh.positions.front());
  glm::dvec3 moment(0);
  for (const glm::uvec3& f : mesh.faces) {
    const glm::dvec3 a = glm::dvec3(mesh.positions[f.x]) - near, b = glm::dvec3(mesh.positions[f.y]) - near,
                     c = glm::dvec3(mesh.positions[f.z]) - near;
    const double volume = glm::dot(a, glm::cross(b, c)) / 6;
    out.volume_m3 += volume;
    out.area_m2 += glm::length(glm::cross(b - a, c - a)) / 2;
    moment += volume * (a + b + c) / 4.0;
  }
  out.centre = near + moment / out.volume_m3;
  return out;
}

double medianFootprint(std::span<const CarvingView> views, const glm::dvec3& centre) {
  std::vector<double> footprints;
  for (const CarvingView& view : views) {
    const PinholeCamera& camera = view.silhouette->camera;
    const double depth = camera.project(centre).z;
    if (depth > 0) footprints.push_back(depth * 2 / (camera.fx + camera.fy));
  }
  return median(std::move(footprints));
}

// Surface of a carving with voxels that suit the bounds.
Result<TriangleMesh> coarseSurface(std::span<const CarvingView> views) {
  FOURDVT_ASSIGN(const CoarseBounds box, coarseBounds(views, kCellsAlong));
  const glm::dvec3 sides = box.high - box.low;
  double voxel_m = std::max({sides.x, sides.y, sides.z}) / kVoxelsAlong;
  std::vector<const silhouette::Silhouette*> silhouettes;
  for (const CarvingView& view : views) silhouettes.push_back(view.silhouette);
  for (int tries = 0;; ++tries, voxel_m /= 2) {
    auto carved = carve(views, voxel_m);
    if (!carved.ok() && tries < kFinerTries) continue;
    if (!carved.ok()) return carved.error();
    TriangleMesh mesh = zeroSurface(carved.value(), 0);
    dropNeedless(mesh, silhouettes, kSpeckVoxels * std::pow(voxel_m, 3));
    if (!mesh.faces.empty() && solidOf(mesh).volume_m3 > 0) return mesh;
    if (tries == kFinerTries)
      return Error{ErrorId::NothingVisible, "the silhouettes leave next to nothing of the performer; check the mattes"};
  }
}

}  // namespace

Result<SceneScale> scaleOf(std::span<const CarvingView> views) {
  FOURDVT_ASSIGN(const TriangleMesh mesh, coarseSurface(views));
  const Solid solid = solidOf(mesh);
  SceneScale out;
  out.bounds = boundsOf(mesh.positions);
  const glm::dvec3 sides = glm::dvec3(out.bounds.max) - glm::dvec3(out.bounds.min);
  out.extent_m = std::max({sides.x, sides.y, sides.z});
  out.centre_in_world = solid.centre;
  out.area_m2 = solid.area_m2;
  out.thickness_m = 3 * solid.volume_m3 / solid.area_m2;
  out.footprint_m = medianFootprint(views, solid.centre);
  if (!(out.footprint_m > 0)) return Error{ErrorId::NothingVisible, "no camera has the performer in front of it"};
  return out;
}

double voxelFor(const SceneScale& scale, size_t max_faces) {
  const double finest_m =
      std::sqrt(kFacesPerVoxel * scale.area_m2 / (kSpareFaces * double(std::max<size_t>(1, max_faces))));
  return std::max(kVoxelFootprints * scale.footprint_m, finest_m);
}

double metresPerPersonMetre(const SceneScale& scale) { return scale.thickness_m / kPersonThickness_m; }

PinholeCamera dividedCamera(const PinholeCamera& camera, double divisor) {
  PinholeCamera out = camera;
  out.cam_from_world[3] = glm::dvec4(glm::dvec3(camera.cam_from_world[3]) / divisor, 1);
  return out;
}

}  // namespace fourdvt::reconstruct
