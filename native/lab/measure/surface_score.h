// SPDX-License-Identifier: Apache-2.0
// Scores of a capture's surfaces, of any topology: by texturing from the camera videos at the held-out cameras, on the
// CPU (projective.h) or on the GPU from the cameras nearest to the view (render/cameras/fvvr.h); and against the
// surfaces of a reference capture. Needs no bake.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "gpu/device.h"
#include "measure/picture_score.h"
#include "lab/measure/surface_distance.h"

namespace fourdvt::measure {

// Means over the held-out views of one sequence, or over its test frames.
struct SurfaceScore {
  std::string sequence;
  size_t views = 0;
  PictureScore picture;  // held-out pictures
  double iou = 0;        // silhouettes of all views
  double triangles = 0;
  // NaN without a reference.
  double to_reference_mean_m = 0, to_reference_median_m = 0, to_reference_p95_m = 0;
  double from_reference_mean_m = 0, from_reference_p95_m = 0;
  // Mean absolute change of the surface's distance from static points of the reference (below `kStill_m`) between a
  // test frame and the next frame.
  double still_change_m = 0;
  size_t still_points = 0;
};
inline constexpr double kStill_m = 0.0005;

struct SurfaceTexturing {
  gpu::Device* device = nullptr;  // null: on the CPU, from all cameras
  int closest = 0;                // on the GPU: number of cameras nearest to the view; 0: all
};

// `reference`: the same sequences and frames with meshes of constant topology; null: none. `on_frame` is called after
// each finished test frame. Errors: those of captures and pictures; FileMissing if a sequence has no held-out pictures.
Result<std::vector<SurfaceScore>> scoreSurfaces(
    const capture::Capture& capture, const capture::Capture* reference, const OpenVideo& open_video,
    const SurfaceTexturing& texturing,
    const std::function<void(const std::string& sequence, uint32_t frame)>& on_frame = {});

// Fixed width, with units.
std::string surfaceTable(const std::vector<SurfaceScore>& scores);

}  // namespace fourdvt::measure
