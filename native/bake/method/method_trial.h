// SPDX-License-Identifier: Apache-2.0
// Leave-one-out trials of methods on one frame of a capture: pictures of left-out cameras, rendered from the other
// cameras' pictures, are compared with the recorded ones. Bake and lab select methods by these scores.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bake/method/frame_drawing.h"
#include "bake/method/method_choice.h"

namespace fourdvt::bake {

constexpr size_t kMaxTrialCameras = 8;  // maximum number of left-out cameras
constexpr int kMaxTrialSide_px =
    1280;  // longer side of a view; cameras with more pixels are scaled down by a whole number

struct TrialFrame {
  const std::vector<PinholeCamera>& cameras;
  const TriangleMesh& surface;
  std::span<const Image> pictures;  // one per camera, RGBA with straight alpha (the matte), with the colours to render
  double length_scale = 1;          // lengthScale in base/mesh.h
};

// Sums over views.
struct TrialSums {
  size_t views = 0;
  double shift_px = 0;              // lengths of the registration shifts of the first method's pictures
  double gap_deg = 0;               // see LeftOut
  std::vector<MethodScore> scores;  // in the order of the methods; cost: not set
};

// Cameras to leave out: at most kMaxTrialCameras, in directions far from each other; none where fewer than three
// have a picture of the surface, since two must remain for blending.
std::vector<size_t> trialCameras(const TrialFrame& frame);

// Scores methods on the views of `left_out` cameras. `drawing` holds the frame. Skips views without a matte, or with
// hardly a blended pixel (view_scores.h). `options`: the player's defaults, with `closest` cameras. Errors: GpuFailure,
// InvalidArgument; Unsupported: a method that this device cannot run.
Result<TrialSums> tryMethods(gpu::Device& device, FrameDrawing& drawing, const TrialFrame& frame,
                             std::span<const size_t> left_out, const std::vector<std::string>& methods,
                             const render::MethodOptions& options = {});

// Adds `more`, from the same methods, to `sums`.
void add(const TrialSums& more, TrialSums& sums);
// Means.
LeftOut meanViews(const TrialSums& sums);
// Means, with the methods' costs on a surface of this many faces. Requires sums.views > 0.
std::vector<MethodScore> meanScores(const TrialSums& sums, size_t faces);

}  // namespace fourdvt::bake
