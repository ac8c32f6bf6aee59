// SPDX-License-Identifier: Apache-2.0
// Methods against each other on one frame of a capture: the pictures of cameras that are left out, drawn from the other
// cameras' pictures, against their own. Bake and lab choose by it. Does NOT read captures and does NOT choose.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bake/method/frame_drawing.h"
#include "bake/method/method_choice.h"

namespace fourdvt::bake {

constexpr size_t kMostTrialCameras = 8;  // that are left out in turn
constexpr int kMostTrialSide_px =
    1280;  // longer side of a view; cameras with more pixels are scaled down by a whole number

struct TrialFrame {
  const std::vector<PinholeCamera>& cameras;
  const TriangleMesh& surface;
  std::span<const Image>
      pictures;             // one per camera, RGBA with straight alpha (the matte), with the colours that are drawn
  double length_scale = 1;  // base/length_scale.h
};

// Sums over views.
struct TrialSums {
  size_t views = 0;
  double shift_px = 0;              // lengths of the registering shifts of the first method's pictures
  double gap_deg = 0;               // see LeftOut
  std::vector<MethodScore> scores;  // as the methods; cost: not set
};

// Cameras to be left out: at most kMostTrialCameras, in directions far from each other; none where fewer than three
// have a picture of the surface, since two must be left to blend.
std::vector<size_t> trialCameras(const TrialFrame& frame);

// `drawing` shows the frame. A view without a matte, or hardly blended anywhere (view_scores.h), does not count.
// Method options: as the player's defaults, `closest` cameras. Errors: GpuFailure, InvalidArgument; Unsupported: a
// method that this device cannot run.
Result<TrialSums> tryMethods(gpu::Device& device, FrameDrawing& drawing, const TrialFrame& frame,
                             std::span<const size_t> left_out, const std::vector<std::string>& methods,
                             const render::MethodOptions& options = {});

// `more` on top of `sums`; of the same methods.
void add(const TrialSums& more, TrialSums& sums);
// Means.
LeftOut meanViews(const TrialSums& sums);
// Means, with the methods' costs on a surface of so many faces. `sums` has views.
std::vector<MethodScore> meanScores(const TrialSums& sums, size_t faces);

}  // namespace fourdvt::bake
