// SPDX-License-Identifier: Apache-2.0
// From one frame's pictures to its surface: silhouettes → hull → (stereo) → (fairing) → checks. Does NOT read or write
// files.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "capture/capture.h"
#include "reconstruct/carve.h"
#include "reconstruct/run/frame_figures.h"
#include "reconstruct/run/options.h"
#include "reconstruct/stereo/stereo_refiner.h"

namespace fourdvt::reconstruct {

struct FrameSurface {
  TriangleMesh mesh;
  std::vector<Silhouette> silhouettes;  // one per camera, empty ones included
  FrameFigures figures;
};

// The alpha of each camera's RGBA picture.
std::vector<Silhouette> silhouettesOf(std::span<const PinholeCamera> cameras, std::span<const Image> pictures);

// Makes surfaces of one sequence after another, frames in order of time.
class SurfaceMaker {
 public:
  // `device` may be null without stereo. Errors: those of StereoRefiner::create.
  static Result<SurfaceMaker> create(const ReconstructOptions& options,
                                     const std::vector<capture::CaptureCamera>& cameras, gpu::Device* device);
  // `pictures`: RGBA, one per camera; alpha is the matte. A camera that sees nothing of the performer is left out.
  // Errors: NothingVisible (fewer than two silhouettes, or no place that they agree on), GpuFailure.
  Result<FrameSurface> make(std::span<const Image> pictures);
  // The next frame follows no other.
  void forget();

 private:
  SurfaceMaker(const ReconstructOptions& options, const std::vector<capture::CaptureCamera>& cameras);
  // `pictures`: those for stereo, asked for if it is used.
  Status makeHull(std::span<const CarvingView> views, const std::function<std::vector<Image>()>& pictures,
                  FrameSurface& out);

  ReconstructOptions options_;
  std::vector<PinholeCamera> cameras_;
  std::vector<Image>
      captured_;  // by camera: 0 where undistortion shows what the lens did not; empty: it did everywhere
  std::unique_ptr<StereoRefiner> stereo_;  // null: hulls stay as they are
};

}  // namespace fourdvt::reconstruct
