// SPDX-License-Identifier: Apache-2.0
// The frames of a capture that a refinement looks at: meshes as given, and the mattes round the figure. About 40
// frames (fewer if the pictures are large, at least one of every sequence), spread evenly, so that memory does not grow
// with the sequences' length. Reads the capture once.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "capture/capture.h"
#include "refine/outline.h"

namespace fourdvt::refine {

struct RefineFrame {
  const capture::CaptureSequence* sequence = nullptr;  // of the capture
  uint32_t index = 0;
  Positions positions;             // as given
  std::vector<glm::vec3> normals;  // of these, of welded vertices
  std::vector<MatteCrop> mattes;   // one per camera
};

struct RefineFrames {
  std::vector<RefineFrame> frames;  // ascending within a sequence
  // [camera][place on the edge] how far the mattes' edges lie outside those that the pictures show, pixels.
  std::vector<std::vector<double>> matte_edges;
};

// `welded_faces`, `same_as`: of the capture's mesh. `on_frame` hears the share of the work done and returns false to
// stop: then the error is Interrupted. Other errors: those of the capture.
Result<RefineFrames> readRefineFrames(const capture::Capture& capture, const OpenVideo& open_video,
                                      const std::vector<glm::uvec3>& welded_faces,
                                      const std::function<bool(double share)>& on_frame);

}  // namespace fourdvt::refine
