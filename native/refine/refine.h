// SPDX-License-Identifier: Apache-2.0
// Makes a capture's mesh and cameras agree with its pictures: the mesh moves along its normals until its outlines lie
// on the mattes' (surface_fit.h), and a camera turns, moves and zooms where that explains more than chance could
// (camera_fit.h). What is trusted: the pictures. Mattes are corrected by the edges that the pictures themselves show
// (outline.h); against the mesh, all mattes too small look like a mesh too large. The mesh's place in the world is
// trusted too: if all cameras and the mesh err alike, nothing changes. algorithms/refinement.md has the formulas.
//
// Does NOT use held-out pictures, does NOT write files.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "capture/capture.h"
#include "refine/camera_fit.h"

namespace fourdvt::refine {

struct RefineOptions {
  bool outline = true;
  bool cameras = true;
  // How far the mattes' edges lie outside the figure's, pixels; negative: eroded. Unset: measured in the pictures.
  std::optional<double> matte_bias_pixels;
  bool any() const { return outline || cameras; }
};

// Distances between the outlines of mesh and matte.
struct Residuals {
  uint32_t points = 0;                       // of the outline, in all frames looked at
  double bias_pixels = 0;                    // median; > 0: the mesh is too small
  double median_pixels = 0, p95_pixels = 0;  // of their sizes
};

struct CameraRefinement {
  std::string name;
  Residuals before, after;
  std::optional<double> measured_bias_pixels;  // of the matte, where enough places on its edge have contrast
  double used_bias_pixels = 0;
  // The change that fits best; it was made only if it is clearly more than its deviation. None where cameras were not
  // asked about, or where the outline says too little.
  std::optional<CameraShift> best;
  bool changed = false;
  glm::dvec3 turn_deg{0}, turn_deviation_deg{0};  // of the changed camera, about its own axes
  double move_m = 0, zoom_percent = 0;
};

// A picture whose outline was far off.
struct WorstPicture {
  std::string sequence;
  uint32_t frame = 0, camera = 0;
  Residuals before, after;
  Image picture;  // RGB: outlinePicture before and after, beside each other
};

// Shares of the points in bins of kBinPixels from -kReachPixels to kReachPixels; what lies beyond is in the last bins.
constexpr double kBinPixels = 0.25, kReachPixels = 3;
using Histogram = std::vector<double>;

struct Refinement {
  RefineOptions options;
  std::shared_ptr<const capture::SurfaceOffsets> offsets;  // null: the mesh stays as given
  std::vector<PinholeCamera> cameras;                      // all of the capture
  std::vector<CameraRefinement> by_camera;
  Histogram before, after;
  std::vector<WorstPicture> worst;  // the first is the worst before; of different cameras
  uint32_t frames = 0, rounds = 0;  // looked at; of the surface fit
  std::vector<std::string> slow;    // sequences whose offsets vary with time
  std::string note;                 // why the surface stayed as given although that was not asked for; else empty
  double offset_low_m = 0, offset_median_m = 0, offset_high_m = 0;  // 5 %, 50 %, 95 % of the constant offsets
  bool changedCameras() const;
};

// `on_progress` hears what is done and its share of the whole, and returns false to stop. The capture must be as given.
// Errors: those of the capture, Interrupted.
Result<Refinement> refineCapture(const capture::Capture& capture, const OpenVideo& open_video,
                                 const RefineOptions& options,
                                 const std::function<bool(const std::string& what, double share)>& on_progress);

// From now on the capture's meshes are read with the offsets, and its cameras are the refined ones.
void applyRefinement(const Refinement& refinement, capture::Capture& capture);

}  // namespace fourdvt::refine
