// SPDX-License-Identifier: Apache-2.0
// From one frame's pictures to its surface: silhouettes → hull → (stereo) → (fairing) → checks. Does NOT read or write
// files.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "capture/capture.h"
#include "reconstruct/carve.h"
#include "reconstruct/run/frame_figures.h"
#include "reconstruct/run/prepare.h"
#include "reconstruct/stereo/stereo_refiner.h"

namespace fourdvt::reconstruct {

struct FrameSurface {
  TriangleMesh mesh;
  TriangleMesh hull;                                // that stereo began with; empty without stereo
  std::vector<silhouette::Silhouette> silhouettes;  // one per camera, empty ones included
  FrameFigures figures;
};

// The alpha of each camera's RGBA picture.
std::vector<silhouette::Silhouette> silhouettesOf(std::span<const PinholeCamera> cameras,
                                                  std::span<const Image> pictures);

// The lengths that a sequence's surfaces are made with.
struct SequenceScale {
  double footprint_m = 0;     // of a pixel on the performer
  double person_metre_m = 1;  // metres of the world per metre of a scene with a performer as thick as a person
  double voxel_m = 0;
};

// By how much stereo reduces pictures in which a pixel on the performer is so large, in a scene with one as thick as a
// person: small pictures stay as they are.
int stereoReduction(double footprint_m);

// Makes surfaces of one sequence after another, frames in order of time. Lengths follow the size of the performer in a
// sequence's first frame, and stay.
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
  // The next frame is of another sequence, with the scale of an earlier run's figures; without them, or if they have
  // none, the scale is taken from that frame.
  Status begin(const FrameFigures* earlier = nullptr);

 private:
  SurfaceMaker(const ReconstructOptions& options, const std::vector<capture::CaptureCamera>& cameras);
  // `pictures`: those for stereo, asked for if it is used.
  Status makeHull(std::span<const CarvingView> views, const std::function<std::vector<Image>()>& pictures,
                  FrameSurface& out);

  // Sets the figures of each camera that sees the performer; meshes are still in the working scene.
  void compareWithSilhouettes(const std::vector<bool>& sees, FrameSurface& out) const;

  Status useScale(const SequenceScale& scale);

  ReconstructOptions options_;
  gpu::Device* device_ = nullptr;
  std::vector<PinholeCamera> cameras_;  // of the capture
  double seen_m3_ = 0;                  // by more than half of them
  std::vector<PinholeCamera> working_;  // of the scene with a performer as thick as a person
  std::optional<SequenceScale> scale_;
  std::vector<Image>
      captured_;  // by camera: 0 where undistortion shows what the lens did not; empty: it did everywhere
  std::unique_ptr<StereoRefiner> stereo_;  // null: hulls stay as they are
};

}  // namespace fourdvt::reconstruct
