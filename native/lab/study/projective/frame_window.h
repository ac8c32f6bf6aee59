// SPDX-License-Identifier: Apache-2.0
// The captured frames that a study looks at, a few at a time: what it asked for last stays in memory, so that memory
// does not grow with the capture. Does NOT change pictures.
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
  static constexpr size_t kKept = 8;  // more than a run of frames

  const capture::Capture& capture_;
  const capture::CaptureSequence& sequence_;
  const OpenVideo open_video_;
  std::unique_ptr<mattes::FrameReader> reader_;
  uint32_t next_ = 0;                      // what the reader gives next
  std::deque<mattes::CaptureFrame> kept_;  // the newest last
};

// `count` of the sequence's test frames, spread over them.
std::vector<uint32_t> spreadTestFrames(const capture::CaptureSequence& sequence, uint32_t count);

}  // namespace fourdvt::study
