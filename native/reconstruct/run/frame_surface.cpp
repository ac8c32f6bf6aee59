// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/frame_surface.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <memory>

#include "base/parallel.h"
#include "base/watch.h"
#include "capture/undistort.h"
#include "reconstruct/carve.h"
#include "reconstruct/mesh_checks.h"
#include "reconstruct/polyhedral_hull.h"
#include "reconstruct/run/silhouette_match.h"
#include "reconstruct/scale.h"
#include "reconstruct/surface_cleaning.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kFairingLoss = 0.002;                    // maximum loss of a camera's overlap by fairing
constexpr double kRoughVoxel_m = 0.02, kSpeck_m3 = 3e-6;  // normalised to a person
constexpr double kCoarsestReduced_m = 0.01;  // normalised to a person: maximum pixel size after reduction for stereo
constexpr size_t kMinPixels = 16;            // minimum size of a silhouette

silhouette::Silhouette silhouetteOf(const PinholeCamera& camera, const Image& rgba) {
  silhouette::Silhouette out{camera, Image(rgba.width, rgba.height, 1)};
  for (size_t i = 0; i < out.coverage.pixels.size(); ++i) out.coverage.pixels[i] = rgba.pixels[4 * i + 3];
  return out;
}

size_t pixelsInside(const silhouette::Silhouette& silhouette) {
  size_t inside = 0;
  for (uint8_t v : silhouette.coverage.pixels) inside += v > 127;
  return inside;
}

double coverOf(const silhouette::Silhouette& silhouette) {
  return double(pixelsInside(silhouette)) / double(std::max<size_t>(1, silhouette.coverage.pixels.size()));
}

// Volume of a closed mesh.
double volumeOf(const TriangleMesh& mesh) {
  double six = 0;
  for (const glm::uvec3& f : mesh.faces) {
    const glm::dvec3 a(mesh.positions[f.x]), b(mesh.positions[f.y]), c(mesh.positions[f.z]);
    six += glm::dot(a, glm::cross(b, c));
  }
  return six / 6;
}

// Bounding box of the performer in the visible space, from a coarse carving: tight, because space outside the pictures
// is not carved. `spare_m`: maximum distance of polygons outside the silhouettes.
Result<BoundingBox> roughBounds(std::span<const CarvingView> views, double spare_m) {
  FOURDVT_ASSIGN(const SparseDistance coarse, carve(views, kRoughVoxel_m));
  glm::dvec3 low(1e9), high(-1e9);
  const auto add = [&](const glm::ivec3& first, const glm::ivec3& last) {
    low = glm::min(low, coarse.origin_in_world + glm::dvec3(first) * kRoughVoxel_m);
    high = glm::max(high, coarse.origin_in_world + glm::dvec3(last) * kRoughVoxel_m);
  };
  for (const SparseDistance::Block& block : coarse.blocks)
    for (size_t i = 0; i < block.values.size(); ++i)
      if (block.values[i] > -coarse.band_m) add(voxelOf(block, i), voxelOf(block, i));
  for (const glm::ivec3& block : coarse.inside) add(block, block + kBlock);
  return BoundingBox{glm::vec3(low - spare_m), glm::vec3(high + spare_m)};
}

// Returns the polyhedral hull, or an error with the reason for falling back to the volumetric hull. `footprint_m`: size
// of a pixel at the performer.
Result<TriangleMesh> checkedPolyhedron(const ReconstructOptions& options, std::span<const CarvingView> views,
                                       double footprint_m, FrameFigures& figures) {
  std::vector<SilhouetteCone> cones(views.size());
  inParallel(views.size(), [&](size_t i) {
    const silhouette::Silhouette& silhouette = *views[i].silhouette;
    cones[i] = {silhouette.camera, silhouette::outlineOf(silhouette.coverage, {options.contour_tolerance_px})};
  });
  FOURDVT_ASSIGN(const BoundingBox bounds, roughBounds(views, options.contour_tolerance_px * footprint_m));
  FOURDVT_ASSIGN(auto hull, polyhedralHull(cones, bounds));
  std::vector<const silhouette::Silhouette*> silhouettes;
  for (const CarvingView& view : views) silhouettes.push_back(view.silhouette);
  figures.parts_left_out = uint32_t(dropNeedless(hull.mesh, silhouettes, kSpeck_m3));
  if (hull.touches_bounds)
    return Error{ErrorId::Internal, "the polyhedral hull reaches where no more than half of the cameras see"};
  if (hull.mesh.faces.empty()) return Error{ErrorId::Internal, "the polyhedral hull is empty"};
  const MeshReport report = checkMesh(hull.mesh);
  if (!report.solid()) return Error{ErrorId::Internal, "the polyhedral hull fails its checks: " + describe(report)};
  return std::move(hull.mesh);
}

// Pictures with the mattes that the hull was carved with; 255 throughout for cameras without silhouette, so that stereo
// is unrestricted in their pictures.
std::vector<Image> withMattes(std::span<const Image> pictures, std::span<const silhouette::Silhouette> carving,
                              const std::vector<bool>& sees) {
  std::vector<Image> out(pictures.begin(), pictures.end());
  for (size_t i = 0; i < out.size(); ++i)
    for (size_t k = 0; k < carving[i].coverage.pixels.size(); ++k)
      out[i].pixels[4 * k + 3] = sees[i] ? carving[i].coverage.pixels[k] : 255;
  return out;
}

}  // namespace

std::vector<silhouette::Silhouette> silhouettesOf(std::span<const PinholeCamera> cameras,
                                                  std::span<const Image> pictures) {
  std::vector<silhouette::Silhouette> out(cameras.size());
  inParallel(cameras.size(), [&](size_t i) { out[i] = silhouetteOf(cameras[i], pictures[i]); });
  return out;
}

int stereoReduction(double footprint_m) { return footprint_m > kCoarsestReduced_m / 2 ? 1 : 2; }

SurfaceMaker::SurfaceMaker(const ReconstructOptions& options, const std::vector<capture::CaptureCamera>& cameras)
    : options_(options), captured_(cameras.size()) {
  for (size_t i = 0; i < cameras.size(); ++i) {
    const PinholeCamera& pinhole = cameras_.emplace_back(cameras[i].pinhole);
    if (cameras[i].distortion.any())
      captured_[i] = capture::Undistorter(cameras[i]).apply(Image(pinhole.width, pinhole.height, 1, 255));
  }
  seen_m3_ = seenVolume(cameras_);
}

Result<SurfaceMaker> SurfaceMaker::create(const ReconstructOptions& options,
                                          const std::vector<capture::CaptureCamera>& cameras, gpu::Device* device) {
  SurfaceMaker maker(options, cameras);
  maker.device_ = device;
  FOURDVT_TRY(maker.useScale({}));  // reports an unusable device or options early
  FOURDVT_TRY(maker.begin());
  return maker;
}

Status SurfaceMaker::begin(const FrameFigures* earlier) {
  forget();
  scale_.reset();
  if (!earlier || !(earlier->voxel_m > 0 && earlier->person_metre_m > 0)) return {};
  return useScale({earlier->footprint_m, earlier->person_metre_m, earlier->voxel_m});
}

Status SurfaceMaker::useScale(const SequenceScale& scale) {
  scale_ = scale;
  working_.clear();
  for (const PinholeCamera& camera : cameras_) working_.push_back(dividedCamera(camera, scale.person_metre_m));
  if (!options_.stereo) return {};
  StereoOptions stereo;
  stereo.adaptivity = options_.adaptivity;
  stereo.reduction = stereoReduction(scale.footprint_m / scale.person_metre_m);
  const float band_m = stereo.sweep.step_m * float(stereo.sweep.labels);
  stereo.sweep.labels = options_.planes;
  stereo.sweep.step_m = band_m / float(options_.planes);
  FOURDVT_ASSIGN(stereo_, StereoRefiner::create(*device_, working_, stereo));
  return {};
}

void SurfaceMaker::forget() {
  if (stereo_) stereo_->forget();
}

Status SurfaceMaker::makeHull(std::span<const CarvingView> views, const std::function<std::vector<Image>()>& pictures,
                              FrameSurface& out) {
  Watch watch;
  if (options_.hull == HullKind::Polyhedral && !stereo_) {
    auto hull = checkedPolyhedron(options_, views, scale_->footprint_m / scale_->person_metre_m, out.figures);
    if (hull.ok()) {
      out.mesh = hull.take();
      out.figures.hull_ms = watch.lap_ms();
      return {};
    }
    out.figures.fallback = hull.error().message;
  }
  FOURDVT_ASSIGN(auto hull, volumetricHull(views, {scale_->voxel_m / scale_->person_metre_m, options_.adaptivity}));
  out.mesh = std::move(hull.mesh);
  out.figures.parts_left_out = uint32_t(hull.dropped);
  out.figures.hull_ms = watch.lap_ms();
  if (!stereo_) return {};
  out.hull = std::move(out.mesh);
  FOURDVT_ASSIGN(out.mesh, stereo_->refine(hull.distance, out.hull, pictures(), views));
  out.figures.believed = stereo_->believed();
  out.figures.stereo_ms = watch.lap_ms();
  return {};
}

void SurfaceMaker::compareWithSilhouettes(const std::vector<bool>& sees, FrameSurface& out) const {
  FrameFigures& figures = out.figures;
  std::vector<std::vector<double>*> lists{&figures.overlap, &figures.outline_px};
  if (stereo_) lists.insert(lists.end(), {&figures.hull_overlap, &figures.moved});
  for (std::vector<double>* list : lists) list->assign(sees.size(), std::numeric_limits<double>::quiet_NaN());
  inParallel(sees.size(), [&](size_t i) {
    if (!sees[i]) return;
    const silhouette::Silhouette silhouette{working_[i], out.silhouettes[i].coverage};
    const SilhouetteMatch match = silhouetteMatch(silhouette, out.mesh);
    figures.overlap[i] = match.overlap, figures.outline_px[i] = match.outline_px;
    if (!stereo_) return;
    figures.hull_overlap[i] = silhouetteOverlap(silhouette, out.hull);
    figures.moved[i] = movedShare(working_[i], out.hull, out.mesh, kMoved_m);
  });
}

Result<FrameSurface> SurfaceMaker::make(std::span<const Image> pictures) {
  const std::vector<PinholeCamera>& cameras = cameras_;
  FrameSurface out;
  Watch watch;
  out.silhouettes = silhouettesOf(cameras, pictures);
  std::vector<silhouette::Silhouette> carving = out.silhouettes;
  std::vector<std::unique_ptr<silhouette::SilhouetteDistance>> distances(cameras.size());
  inParallel(cameras.size(), [&](size_t i) {
    if (pixelsInside(carving[i]) < kMinPixels) return;
    for (size_t k = 0; k < captured_[i].pixels.size(); ++k)
      if (captured_[i].pixels[k] < 128) carving[i].coverage.pixels[k] = 255;  // unseen space is not carved
    distances[i] = std::make_unique<silhouette::SilhouetteDistance>(carving[i].coverage);
  });
  std::vector<CarvingView> views;
  std::vector<bool> sees;
  for (size_t i = 0; i < cameras.size(); ++i) {
    sees.push_back(distances[i] != nullptr);
    if (distances[i]) views.push_back({&carving[i], *distances[i]});
  }
  out.figures.silhouettes_ms = watch.lap_ms();
  if (views.size() < 2) {
    return Error{ErrorId::NothingVisible,
                 "fewer than two cameras see anything of the performer; check the mattes, or the plates that the "
                 "pictures are keyed against; frames in which nobody is on stage must be cut off"};
  }

  if (!scale_) {
    FOURDVT_ASSIGN(const SceneScale scene, scaleOf(views));
    const double voxel_m = options_.voxel_m > 0 ? options_.voxel_m : voxelFor(scene, size_t(options_.faces));
    FOURDVT_TRY(useScale({scene.footprint_m, metresPerPersonMetre(scene), voxel_m}));
  }
  for (size_t i = 0; i < cameras.size(); ++i) carving[i].camera = working_[i];
  out.figures.footprint_m = scale_->footprint_m;
  out.figures.person_metre_m = scale_->person_metre_m;
  out.figures.voxel_m = scale_->voxel_m;
  watch.lap_ms();

  FOURDVT_TRY(makeHull(
      views, [&] { return withMattes(pictures, carving, sees); }, out));
  out.figures.triangles_made = uint32_t(out.mesh.faces.size());
  simplify(out.mesh, size_t(options_.faces));
  watch.lap_ms();

  const auto overlapIn = [&](size_t i, const TriangleMesh& mesh) {
    return silhouetteOverlap({working_[i], out.silhouettes[i].coverage}, mesh);
  };
  if (options_.fairing > 0) {
    std::vector<double> least(cameras.size(), 0);
    inParallel(cameras.size(), [&](size_t i) {
      if (distances[i]) least[i] = overlapIn(i, out.mesh) - kFairingLoss;
    });
    fairSurface(out.mesh, views, options_.fairing, [&](const TriangleMesh& mesh) {
      std::atomic<bool> good = true;
      inParallel(cameras.size(), [&](size_t i) {
        if (distances[i] && overlapIn(i, mesh) < least[i]) good = false;
      });
      return good.load();
    });
    out.figures.fairing_ms = watch.lap_ms();
  }

  out.figures.vertices = uint32_t(out.mesh.positions.size());
  out.figures.triangles = uint32_t(out.mesh.faces.size());
  compareWithSilhouettes(sees, out);
  for (TriangleMesh* mesh : {&out.mesh, &out.hull})
    for (glm::vec3& p : mesh->positions) p = glm::vec3(glm::dvec3(p) * scale_->person_metre_m);
  out.figures.volume_m3 = volumeOf(out.mesh);
  out.figures.seen_m3 = seen_m3_;
  for (const silhouette::Silhouette& silhouette : out.silhouettes) out.figures.cover.push_back(coverOf(silhouette));
  out.figures.check_ms = watch.lap_ms();
  return out;
}

}  // namespace fourdvt::reconstruct
