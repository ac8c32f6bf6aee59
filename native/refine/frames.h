// SPDX-License-Identifier: Apache-2.0
// Frames of a capture used by a refinement: meshes as given, and the mattes around the figure. About 40 frames (fewer
// for large pictures, at least one per sequence), evenly spread, so that memory is independent of the sequences'
// length. Reads the capture once.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "capture/capture.h"
#include "refine/outline.h"

namespace fourdvt::refine {

struct RefineFrame {
  const capture::CaptureSequence* sequence = nullptr;  // borrowed from the capture
  uint32_t index = 0;
  Positions positions;             // unmodified mesh
  std::vector<glm::vec3> normals;  // unit, per welded vertex
  std::vector<MatteCrop> mattes;   // [camera]
};

struct RefineFrames {
  std::vector<RefineFrame> frames;  // ascending within a sequence
  // [camera][edge sample] distances of the mattes' edges outside the picture's edges, pixels.
  std::vector<std::vector<double>> matte_edges;
};

// `welded_faces`, `same_as`: topology of the capture's mesh. `on_frame` receives the finished share and returns false
// to stop (error Interrupted). Other errors: those of the capture.
Result<RefineFrames> readRefineFrames(const capture::Capture& capture, const OpenVideo& open_video,
                                      const std::vector<glm::uvec3>& welded_faces,
                                      const std::function<bool(double share)>& on_frame);

}  // namespace fourdvt::refine
