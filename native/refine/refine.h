// SPDX-License-Identifier: Apache-2.0
// Aligns a capture's mesh and cameras with its pictures: offsets along the vertex normals move the mesh until its
// outlines match the mattes' (surface_fit.h), and pose and focal length of a camera change where that is statistically
// significant (camera_fit.h). Mattes are corrected by the edges in the pictures (matteEdgeOffsets in outline.h), since
// uniformly eroded mattes look like a mesh that is too large. The mesh's pose in the world is fixed: an error common to
// all cameras and the mesh is not observable. Formulas: algorithms/refinement.md.
//
// Uses no held-out pictures.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "capture/capture.h"
#include "refine/camera_fit.h"

namespace fourdvt::store {
class Archive;
}

namespace fourdvt::refine {

struct RefineOptions {
  bool outline = true;
  bool cameras = true;
  // Distance of the mattes' edges outside the figure's, pixels; negative: eroded. Unset: measured in the pictures.
  std::optional<double> matte_bias_pixels;
  bool any() const { return outline || cameras; }
};

// Distances between the outlines of mesh and matte.
struct Residuals {
  uint32_t points = 0;                       // outline points in all frames used
  double bias_pixels = 0;                    // median; > 0: the mesh is too small
  double median_pixels = 0, p95_pixels = 0;  // quantiles of absolute values
};

struct CameraRefinement {
  std::string name;
  Residuals before, after;
  std::optional<double> measured_bias_pixels;  // matte bias; unset: too few edge samples with contrast
  double used_bias_pixels = 0;
  // Change with the best fit; applied only if significant. None where cameras were not refined, or constraints are too
  // few.
  std::optional<CameraShift> best;
  bool changed = false;
  glm::dvec3 turn_deg{0}, turn_deviation_deg{0};  // applied change, about the camera's own axes
  double move_m = 0, zoom_percent = 0;
};

// Picture with a large outline error.
struct WorstPicture {
  std::string sequence;
  uint32_t frame = 0, camera = 0;
  Residuals before, after;
  Image picture;  // RGB: outlinePicture before and after, side by side
};

// Shares of points in bins of kBinPixels from -kReachPixels to kReachPixels; the outer bins include all beyond.
constexpr double kBinPixels = 0.25, kReachPixels = 3;
using Histogram = std::vector<double>;

struct Refinement {
  RefineOptions options;
  std::shared_ptr<const capture::SurfaceOffsets> offsets;  // null: the mesh stays as given
  std::vector<PinholeCamera> cameras;                      // all cameras of the capture
  std::vector<CameraRefinement> by_camera;
  Histogram before, after;
  std::vector<WorstPicture> worst;  // worst picture before refinement first; one per camera
  uint32_t frames = 0, rounds = 0;  // frames used; rounds of the surface fit
  std::vector<std::string> slow;    // sequences whose offsets vary with time
  std::string note;                 // reason for an unchanged surface that was to be refined; else empty
  double offset_low_m = 0, offset_median_m = 0, offset_high_m = 0;  // 5 %, 50 %, 95 % quantiles of the constant offsets
  bool changedCameras() const;
};

// `on_progress` receives a stage and the finished share of the whole, and returns false to stop. The capture must be
// unrefined. Errors: those of the capture, Interrupted.
Result<Refinement> refineCapture(const capture::Capture& capture, const OpenVideo& open_video,
                                 const RefineOptions& options,
                                 const std::function<bool(const std::string& what, double share)>& on_progress);

// Adds the offsets to the meshes that the capture reads from now on, and replaces its cameras by the refined ones.
void applyRefinement(const Refinement& refinement, capture::Capture& capture);

// Reads a refinement that is kept between bakes (store/folder.h). Errors: FileMissing, FileUnreadable; Internal for a
// damaged file or one of another capture.
Result<Refinement> loadRefinement(const std::string& path, const capture::Capture& capture);
// Hash of the changes to a capture, without the measurements.
uint64_t changeHash(const Refinement& refinement);

}  // namespace fourdvt::refine

namespace fourdvt::store {

void fields(Archive& a, refine::RefineOptions& o);
void fields(Archive& a, refine::Refinement& r);

}  // namespace fourdvt::store
