// SPDX-License-Identifier: Apache-2.0
// Frames of one sequence, from their pictures to files in the frame store. A sequence is cut into windows: surfaces
// depend on the frames before them in their window, where stereo keeps them steady, and on the sequence's first frame,
// whose figures hold the lengths that all are made with. So windows may be made in any order, by any process, once the
// first frame is there.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "mattes/frame_reader.h"
#include "reconstruct/run/frame_store.h"
#include "reconstruct/run/frame_surface.h"
#include "reconstruct/run/prepare.h"

namespace fourdvt::reconstruct {

inline constexpr uint32_t kWindow = 32;  // frames after which a surface no longer depends on those before

inline uint32_t windowsOf(const capture::CaptureSequence& sequence) {
  return (sequence.frame_count + kWindow - 1) / kWindow;
}
// End of a window's frames.
inline uint32_t windowEnd(const capture::CaptureSequence& sequence, uint32_t window) {
  return std::min((window + 1) * kWindow, sequence.frame_count);
}

class SequenceFrames {
 public:
  using Made = std::function<void(uint32_t frame, const mattes::CaptureFrame& captured, const FrameSurface& surface)>;

  // Borrows all of them. The maker serves no other sequence meanwhile.
  SequenceFrames(const Prepared& job, const ReconstructEnvironment& environment, const FrameStore& store,
                 SurfaceMaker& maker, const capture::CaptureSequence& sequence)
      : job_(job), environment_(environment), store_(store), maker_(maker), sequence_(sequence) {}

  // Makes frame 0, unless it is there. Errors: those of makeWindow.
  Status makeFirst(const Made& made = {});
  // Makes what is missing of a window, with stereo all of it; returns how many of its frames were kept. Windows of one
  // object go up. `made` is called after each frame that is saved. Errors: those of pictures; NothingVisible and
  // InvalidArgument (silhouettes that contradict each other), naming sequence and frame; Internal (no first frame);
  // GpuFailure; WriteFailed; Interrupted.
  Result<uint32_t> makeWindow(uint32_t window, const Made& made = {});

 private:
  Status begin(uint32_t frame);
  Status make(uint32_t frame, const Made& made);
  Status checkAgreement(uint32_t frame, const std::vector<Image>& pictures);
  std::string nameOf(uint32_t frame) const {
    return job_.folderOf(sequence_.name) + ", frame " + std::to_string(frame) + ": ";
  }

  const Prepared& job_;
  const ReconstructEnvironment& environment_;
  const FrameStore& store_;
  SurfaceMaker& maker_;
  const capture::CaptureSequence& sequence_;
  std::unique_ptr<mattes::FrameReader> reader_;  // null: no frame was made yet
  bool agreed_ = false;                          // silhouettes were judged, in this window or in frame 0
};

}  // namespace fourdvt::reconstruct
