// SPDX-License-Identifier: Apache-2.0
// Surface of one frame from its pictures: silhouettes → hull → (stereo) → (fairing) → checks. Accesses no files.
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
  TriangleMesh hull;                                // input of stereo; empty without stereo
  std::vector<silhouette::Silhouette> silhouettes;  // one per camera, possibly empty
  FrameFigures figures;
};

// Silhouettes from the alpha of each camera's RGBA picture.
std::vector<silhouette::Silhouette> silhouettesOf(std::span<const PinholeCamera> cameras,
                                                  std::span<const Image> pictures);

// Lengths shared by all surfaces of a sequence.
struct SequenceScale {
  double footprint_m = 0;     // size of a pixel at the performer
  double person_metre_m = 1;  // metres of the world per metre of a scene with a performer as thick as a person
  double voxel_m = 0;
};

// Reduction factor of pictures for stereo, by the footprint of a pixel in a scene with a performer as thick as a
// person; small pictures are not reduced.
int stereoReduction(double footprint_m);

// Makes the surfaces of one sequence after another, frames in temporal order. Lengths follow the performer's size in a
// sequence's first frame and stay fixed.
class SurfaceMaker {
 public:
  // `device` may be null without stereo. Errors: those of StereoRefiner::create.
  static Result<SurfaceMaker> create(const ReconstructOptions& options,
                                     const std::vector<capture::CaptureCamera>& cameras, gpu::Device* device);
  // `pictures`: RGBA, one per camera; alpha is the matte. Cameras with empty silhouettes are skipped. Errors:
  // NothingVisible (fewer than two silhouettes, or no common volume), GpuFailure.
  Result<FrameSurface> make(std::span<const Image> pictures);
  // Resets the temporal state before a cut.
  void forget();
  // Begins another sequence, with the scale of an earlier run's figures; without these the next frame determines it.
  Status begin(const FrameFigures* earlier = nullptr);

 private:
  SurfaceMaker(const ReconstructOptions& options, const std::vector<capture::CaptureCamera>& cameras);
  // `pictures` returns the pictures for stereo; called only if stereo is used.
  Status makeHull(std::span<const CarvingView> views, const std::function<std::vector<Image>()>& pictures,
                  FrameSurface& out);

  // Sets the figures of each camera with a silhouette; meshes are still in the normalised scene.
  void compareWithSilhouettes(const std::vector<bool>& sees, FrameSurface& out) const;

  Status useScale(const SequenceScale& scale);

  ReconstructOptions options_;
  gpu::Device* device_ = nullptr;
  std::vector<PinholeCamera> cameras_;  // capture cameras
  double seen_m3_ = 0;                  // volume seen by more than half of the cameras
  std::vector<PinholeCamera> working_;  // scene with a performer as thick as a person
  std::optional<SequenceScale> scale_;
  std::vector<Image>
      captured_;  // [camera] mask, 0 outside the lens's picture after undistortion; empty: no such pixels
  std::unique_ptr<StereoRefiner> stereo_;  // null: no stereo
};

}  // namespace fourdvt::reconstruct
