// SPDX-License-Identifier: Apache-2.0
// Stereo refinement of the visual hull: the hull says where the surface may be, the pictures' agreement says where it
// is. Does NOT move anything out of the hull, needs no mesh of the performer and corrects no calibration.
// Stages in order of execution: plane_sweep.h, plane_sweep.h, plane_sweep.h, depth_fusion.h,
// depth_fusion.h, steady.h, outlines.h.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/result.h"
#include "gpu/device.h"
#include "reconstruct/level_set.h"
#include "reconstruct/stereo/depth_fusion.h"
#include "reconstruct/stereo/outlines.h"
#include "reconstruct/stereo/plane_sweep.h"

namespace fourdvt::reconstruct {
struct StereoOptions {
  int reduction = 2;           // pictures are reduced by this factor along each side first
  size_t neighbours = 2;       // cameras that each camera is compared with, the nearest in angle
  double narrowest_deg = 20;   // below this angle pictures say little about depth: cameras beyond it come first
  double widest_deg = 100;     // beyond this angle between the rays through their middles cameras are not compared
  double agreement_m = 0.010;  // between depth maps of two cameras
  float kept = 0.8f;           // share of the frame before where the pictures stand still, 0 … 1
  double adaptivity = 0.3;     // of the mesh, 0 … 1: fewer faces where the surface is flat
  PlaneSweepOptions sweep;
  SemiGlobalOptions smoothing;
  FusionOptions fusion;
  MembraneOptions membrane;
  OutlineOptions outlines;
  std::string check() const;  // what is wrong, or nothing
};

// The cameras that one camera is compared with: the nearest in angle from `narrowest_deg` on, then those below it, the
// widest first. Fewer than `neighbours` where the others are too far.
std::vector<size_t> comparedWith(std::span<const PinholeCamera> cameras, size_t camera, const StereoOptions& options);

struct StereoTimes {  // of one frame, seconds
  double sweep = 0, smoothing = 0, agreement = 0, fusion = 0, outlines = 0, mesh = 0;
};

class StereoRefiner {
 public:
  // At least two cameras. `device` is borrowed and must outlive this. Errors: InvalidArgument, GpuFailure.
  static Result<std::unique_ptr<StereoRefiner>> create(gpu::Device& device, std::vector<PinholeCamera> cameras,
                                                       const StereoOptions& options = {});
  virtual ~StereoRefiner() = default;
  // Frames in order of time; the same frames in the same order give the same surfaces. `hull`: the zero surface of
  // `hull_distance`. `rgba_pictures`: one per camera, of its size, alpha = matte. `views`: those that the hull was
  // carved with. Keeps one frame. Errors: InvalidArgument (a picture's size), GpuFailure.
  virtual Result<TriangleMesh> refine(const SparseDistance& hull_distance, const TriangleMesh& hull,
                                      std::span<const Image> rgba_pictures, std::span<const CarvingView> views) = 0;
  // The next frame follows no other: a cut.
  virtual void forget() = 0;
  virtual const StereoTimes& times() const = 0;  // of the last frame
  // Last frame, per camera: the share of its picture of the hull in which its depths are believed.
  virtual const std::vector<double>& believed() const = 0;
};

// How much a picture shows that stereo can match. Does NOT look at other pictures.

// Per pixel of an RGBA picture whose alpha is the matte, height × width: 0 where the surroundings show nothing but
// noise and slow shading, towards 1 where they are full of contrast. Pixels beside the outline do not count: the
// backdrop's colour and the codec reach into them.
std::vector<float> textureOf(const Image& rgba);

// Multiplies the weights of a map with what its camera's picture shows there, and forgets depths where that is nothing.
void weighByTexture(const Image& rgba, DepthMap& map);

}  // namespace fourdvt::reconstruct
