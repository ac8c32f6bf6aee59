// SPDX-License-Identifier: Apache-2.0
// Frames of a capture: all cameras in step, one frame at a time, so that memory is independent of the length. Cameras
// are decoded in parallel on OpenCV's threads; those without mattes are keyed against their plates. Pictures are
// undistorted to the capture's pinhole cameras, without skew. No cache, no GPU. Errors name the file and the remedy.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"
#include "base/result.h"
#include "base/video.h"
#include "capture/capture.h"

namespace fourdvt::mattes {

// Opens a capture folder and checks everything that can be checked without decoding whole videos, before any long work
// starts: capture::openDescription, the videos' containers, and the first frame of every sequence.
Result<capture::Capture> openCapture(const std::string& folder, const OpenVideo& open_video,
                                     const std::vector<std::string>& only = {},
                                     capture::MeshNeed need = capture::MeshNeed::ConstantTopology,
                                     capture::MatteNeed mattes = capture::MatteNeed::Required);

// Opens sequences of a folder made by linkCapture. Errors: those of openCapture; messages name the capture that the
// links lead to. All paths in capture.json must resolve from the new folder.
Result<capture::Capture> openLinked(const std::string& folder, const std::string& linked_capture,
                                    const std::vector<std::string>& sequences, const OpenVideo& open_video);

struct CaptureFrame {
  uint32_t index = 0;
  std::vector<Image> pictures;    // RGBA per camera: sRGB colour, alpha = matte
  Positions positions;            // metres; empty if the capture has no meshes
  std::vector<glm::uvec3> faces;  // per-frame topology only; constant faces are in the capture's topology
};

class FrameReader {
 public:
  // The first call of next() returns `first_frame`. With MatteNeed::None, alpha is 255 all over. Errors: those of
  // openCapture for pictures.
  static Result<std::unique_ptr<FrameReader>> open(const capture::Capture& capture,
                                                   const capture::CaptureSequence& sequence,
                                                   const OpenVideo& open_video, uint32_t first_frame = 0,
                                                   capture::MatteNeed mattes = capture::MatteNeed::Required);
  ~FrameReader();
  // Sets the next frame, which must not lie before the current one.
  void skipTo(uint32_t frame);
  // Reads the next frame. Errors: VideoTooShort, FrameSize, FileUnreadable, MeshTopology, MeshNotFinite …
  Result<CaptureFrame> next();

 private:
  class Camera;
  FrameReader(const capture::Capture& capture, const capture::CaptureSequence& sequence, uint32_t first);
  Status readSurface(CaptureFrame& frame) const;

  const capture::Capture capture_;
  const capture::CaptureSequence sequence_;
  uint32_t next_frame_;
  std::vector<Camera> cameras_;
};

}  // namespace fourdvt::mattes
