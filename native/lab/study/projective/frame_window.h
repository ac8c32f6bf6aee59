// SPDX-License-Identifier: Apache-2.0
// Window over the captured frames of a study: keeps the latest requests in memory, so that memory is independent of the
// capture's length.
#pragma once

#include <deque>
#include <memory>

#include "capture/capture.h"
#include "mattes/frame_reader.h"

namespace fourdvt::study {

class FrameWindow {
 public:
  FrameWindow(const capture::Capture& capture, const capture::CaptureSequence& sequence, OpenVideo open_video)
      : capture_(capture), sequence_(sequence), open_video_(std::move(open_video)) {}
  const capture::CaptureSequence& sequence() const { return sequence_; }
  // Valid until the next call. Errors: those of FrameReader.
  Result<const mattes::CaptureFrame*> at(uint32_t frame);

 private:
  static constexpr size_t kKept = 8;  // exceeds a run of frames

  const capture::Capture& capture_;
  const capture::CaptureSequence& sequence_;
  const OpenVideo open_video_;
  std::unique_ptr<mattes::FrameReader> reader_;
  uint32_t next_ = 0;                      // next frame of the reader
  std::deque<mattes::CaptureFrame> kept_;  // newest last
};

// `count` of the sequence's test frames, spread over them.
std::vector<uint32_t> spreadTestFrames(const capture::CaptureSequence& sequence, uint32_t count);

}  // namespace fourdvt::study
