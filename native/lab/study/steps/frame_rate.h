// SPDX-License-Identifier: Apache-2.0
// Frame rate of the layered character against free-viewpoint rendering, FVVR (Volino and Hilton 2013, 4.4), in one run,
// on the same frames, views and picture sizes, with interleaved methods. A frame is all playback work after decoding:
// upload, geometry, depth maps (FVVR), drawing. FVVR is timed with all N cameras and with the M nearest to the view,
// each time with the uploads and depth maps of the used cameras only. Decoding is excluded for both (one video here,
// one video per camera there).
#pragma once

#include <atomic>
#include <string>
#include <utility>
#include <vector>

#include "capture/capture.h"
#include "gpu/device.h"

namespace fourdvt::study {

struct FrameRateOptions {
  std::string sequence;  // empty: the character's first
  std::vector<std::pair<int, int>> sizes = {{512, 512}, {720, 960}};
  int frames = 16;                 // measured per size, each at another azimuth
  std::vector<int> closest{0, 3};  // values of M measured for FVVR; 0, or N and above: all cameras
  const std::atomic<bool>* stop = nullptr;
};

// Medians in milliseconds. `frame_ms` is one undisturbed frame; the parts are timed separately, with the GPU drained
// between them, and their sum exceeds it. Read-back is excluded.
struct PassTimes {
  double frame_ms = 0;
  double upload_ms = 0;      // decoded pictures into textures (FVVR: cropped round the mesh and premultiplied)
  double geometry_ms = 0;    // normals and tables
  double depth_maps_ms = 0;  // FVVR only
  double shading_ms = 0;     // drawing and resolving
  double readback_ms = 0;
  double framesPerSecond() const { return 1000 / frame_ms; }
};

// FVVR from the M cameras nearest to the view.
struct FvvrRate {
  int closest = 0;  // M; 0: all cameras
  PassTimes times;
};

struct FrameRate {
  int width = 0, height = 0;
  PassTimes layered;
  std::vector<FvvrRate> fvvr;  // in the order of FrameRateOptions::closest
  double ratio(const PassTimes& theirs) const {
    return theirs.frame_ms / layered.frame_ms;
  }  // ratio of the frame rates
  double drawRatio(const PassTimes& theirs) const {
    return (theirs.depth_maps_ms + theirs.shading_ms) / layered.shading_ms;
  }
  double shadingRatio(const PassTimes& theirs) const { return theirs.shading_ms / layered.shading_ms; }
};

struct FrameRates {
  std::string renderer, sequence;
  int layers = 0, layer_side = 0, cameras = 0, frames = 0;
  uint32_t faces = 0;
  uint64_t layered_bytes = 0, fvvr_bytes = 0;  // textures held on the GPU
  std::vector<FrameRate> sizes;
};

// Errors: those of reading the character and the capture; Interrupted.
Result<FrameRates> measureFrameRates(gpu::Device& device, const capture::Capture& capture, const OpenVideo& open_video,
                                     const std::string& character_folder, const FrameRateOptions& options = {});

std::string frameRateTable(const FrameRates& rates);

}  // namespace fourdvt::study
