// SPDX-License-Identifier: Apache-2.0
#include "lab/study/projective/frame_window.h"

#include <algorithm>

#include "mattes/frame_reader.h"

namespace fourdvt::study {

Result<const mattes::CaptureFrame*> FrameWindow::at(uint32_t frame) {
  for (const mattes::CaptureFrame& kept : kept_)
    if (kept.index == frame) return &kept;
  if (!reader_ || frame < next_) {
    FOURDVT_ASSIGN(reader_, mattes::FrameReader::open(capture_, sequence_, open_video_, frame));
  } else {
    reader_->skipTo(frame);
  }
  if (kept_.size() >= kKept) kept_.pop_front();
  FOURDVT_ASSIGN(auto read, reader_->next());
  next_ = frame + 1;
  kept_.push_back(std::move(read));
  return &kept_.back();
}

std::vector<uint32_t> spreadTestFrames(const capture::CaptureSequence& sequence, uint32_t count) {
  const std::vector<uint32_t>& all = sequence.test_frames;
  if (count >= all.size()) return all;
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < count; ++i) out.push_back(all[(2 * i + 1) * all.size() / (2 * count)]);
  return out;
}

}  // namespace fourdvt::study
