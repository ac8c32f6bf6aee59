// SPDX-License-Identifier: Apache-2.0
// Stereo refinement of the visual hull: the hull bounds the surface, photo-consistency locates it inside. Uses given
// calibrations and no mesh of the performer. Stages: plane sweep, semi-global matching and consistency (plane_sweep.h),
// fusion and membrane (depth_fusion.h), temporal averaging (steady.h), silhouettes (outlines.h).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/result.h"
#include "base/watch.h"
#include "gpu/device.h"
#include "reconstruct/level_set.h"
#include "reconstruct/stereo/depth_fusion.h"
#include "reconstruct/stereo/outlines.h"
#include "reconstruct/stereo/plane_sweep.h"
#include "reconstruct/stereo/steady.h"

namespace fourdvt::reconstruct {
struct StereoOptions {
  int reduction = 2;           // reduction factor of pictures along each side
  size_t neighbours = 2;       // nearest cameras in angle that each camera is compared with
  double narrowest_deg = 20;   // below this angle depth is uncertain: cameras beyond it are preferred
  double widest_deg = 100;     // maximum angle between the central rays of compared cameras
  double agreement_m = 0.010;  // tolerance between depth maps of two cameras
  float kept = 0.8f;           // weight of the previous frame where pictures are static, 0 … 1
  double adaptivity = 0.3;     // mesh adaptivity, 0 … 1: fewer faces where the surface is flat
  PlaneSweepOptions sweep;
  SemiGlobalOptions smoothing;
  FusionOptions fusion;
  MembraneOptions membrane;
  OutlineOptions outlines;
  std::string check() const;  // error message, or empty
};

// Cameras compared with `camera`: the nearest in angle from `narrowest_deg` on, then those below it in decreasing
// order. Fewer than `neighbours` where others are beyond `widest_deg`.
std::vector<size_t> comparedWith(std::span<const PinholeCamera> cameras, size_t camera, const StereoOptions& options);

struct StereoTimes {  // one frame, seconds
  double sweep = 0, smoothing = 0, agreement = 0, fusion = 0, outlines = 0, mesh = 0;
};

class StereoRefiner {
 public:
  // Requires at least two cameras. `device` is borrowed and must outlive the object. Errors: InvalidArgument,
  // GpuFailure.
  static Result<std::unique_ptr<StereoRefiner>> create(gpu::Device& device, std::vector<PinholeCamera> cameras,
                                                       const StereoOptions& options = {});
  // Refines frames in temporal order; equal sequences of frames have equal surfaces. `hull`: zero surface of
  // `hull_distance`. `rgba_pictures`: one per camera, of its size, alpha = matte. `views`: those that the hull was
  // carved with. Stores one frame. Errors: InvalidArgument (a picture's size), GpuFailure.
  Result<TriangleMesh> refine(const SparseDistance& hull_distance, const TriangleMesh& hull,
                              std::span<const Image> rgba_pictures, std::span<const CarvingView> views);
  // Resets the temporal state before a cut.
  void forget() { steady_.forget(); }
  const StereoTimes& times() const { return times_; }  // last frame
  // Last frame, per camera: share of the hull's picture with valid depths.
  const std::vector<double>& believed() const { return believed_; }

 private:
  StereoRefiner(std::vector<PinholeCamera> cameras, const StereoOptions& options);
  Result<std::vector<Image>> reduced(std::span<const Image> pictures) const;
  Result<std::vector<DepthMap>> depthMaps(std::span<const Image> pictures);
  // Adds the time since the last call to `to`.
  void lap(double& to) { to += watch_.lap_ms() / 1e3; }

  std::vector<PinholeCamera> full_, cameras_;  // cameras_: reduced pictures
  StereoOptions options_;
  std::vector<StereoReference> references_;
  PlaneSweep sweep_;
  SteadyDistance steady_;
  StereoTimes times_;
  std::vector<double> believed_;
  Watch watch_;
};

// Texture of an RGBA picture (alpha = matte) for stereo, height × width: 0 where the neighbourhood has only noise and
// slow shading, towards 1 for high contrast. Pixels beside the outline are excluded, since they contain the backdrop's
// colour and codec artefacts.
std::vector<float> textureOf(const Image& rgba);

// Multiplies a map's weights with the picture's texture; depths without texture become unknown.
void weighByTexture(const Image& rgba, DepthMap& map);

}  // namespace fourdvt::reconstruct
