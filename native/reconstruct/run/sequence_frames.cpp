// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/sequence_frames.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "base/watch.h"
#include "mattes/agreement.h"
#include "mattes/frame_reader.h"

namespace fourdvt::reconstruct {
namespace {

constexpr size_t kFewestJudged = 3;  // silhouettes; two hardly contradict each other

bool wasJudged(const FrameFigures& figures) {
  return std::count_if(figures.overlap.begin(), figures.overlap.end(), [](double v) { return !std::isnan(v); }) >=
         std::ptrdiff_t(kFewestJudged);
}

}  // namespace

Status SequenceFrames::makeFirst(const Made& made) { return store_.find(sequence_.name, 0) ? Status() : make(0, made); }

Result<uint32_t> SequenceFrames::makeWindow(uint32_t window, const Made& made) {
  const uint32_t first = window * kWindow, end = windowEnd(sequence_, window);
  std::vector<bool> there;
  const auto earliest = store_.find(sequence_.name, 0);
  agreed_ = earliest && wasJudged(*earliest);
  for (uint32_t frame = first; frame < end; ++frame) {
    const auto kept = store_.find(sequence_.name, frame);
    there.push_back(kept.has_value());
    agreed_ = agreed_ || (kept && !job_.options.stereo && wasJudged(*kept));
  }
  const auto count = uint32_t(std::count(there.begin(), there.end(), true));
  if (count == end - first) return count;
  for (uint32_t frame = first; frame < end; ++frame)
    if (job_.options.stereo || !there[frame - first]) FOURDVT_TRY(make(frame, made));
  return job_.options.stereo ? 0 : count;
}

// The scale of the sequence is that of its first frame.
Status SequenceFrames::begin(uint32_t frame) {
  const auto earliest = store_.find(sequence_.name, 0);
  if (!earliest && frame > 0)
    return Error{ErrorId::Internal, nameOf(frame) + "cannot be made before the sequence's first frame"};
  FOURDVT_TRY(maker_.begin(earliest ? &*earliest : nullptr));
  FOURDVT_ASSIGN(reader_, mattes::FrameReader::open(job_.capture, sequence_, environment_.open_video, frame));
  return {};
}

Status SequenceFrames::make(uint32_t frame, const Made& made) {
  if (environment_.stop && *environment_.stop) {
    return Error{ErrorId::Interrupted,
                 "stopped; finished frames are kept in " + resultFolder(job_.options).partFolder() + " for --resume"};
  }
  if (!reader_) FOURDVT_TRY(begin(frame));
  const Watch watch;
  reader_->skipTo(frame);
  FOURDVT_ASSIGN(const auto captured, reader_->next());
  const double read_ms = watch.ms();
  FOURDVT_TRY(checkAgreement(frame, captured.pictures));
  if (frame % kWindow == 0) maker_.forget();
  auto surface = maker_.make(captured.pictures);
  if (!surface.ok()) {
    return Error{surface.error().id,
                 nameOf(frame) + surface.error().message + "; finished frames are kept for --resume"};
  }
  surface.value().figures.read_ms = read_ms;
  FOURDVT_TRY(store_.save(sequence_.name, frame, surface.value().mesh, surface.value().figures));
  if (made) made(frame, captured, surface.value());
  return {};
}

// Judges the silhouettes of the sequence's first frame; where too few see the performer there, those of the first frame
// of each window that has enough of them, so that windows are accepted alike in any order.
Status SequenceFrames::checkAgreement(uint32_t frame, const std::vector<Image>& pictures) {
  if (job_.options.any_silhouettes || job_.options.mattes_alone || agreed_) return {};
  std::vector<capture::CaptureCamera> cameras;
  std::vector<cv::Mat> masks;
  size_t seeing = 0;
  for (size_t i = 0; i < pictures.size(); ++i) {
    cameras.push_back({job_.capture.cameras[i].pinhole, {}});
    cv::Mat mask(pictures[i].height, pictures[i].width, CV_8U);
    for (int k = 0; k < int(mask.total()); ++k)
      mask.at<uint8_t>(k) = pictures[i].pixels[4 * size_t(k) + 3] >= 128 ? 255 : 0;
    masks.push_back(mask);
    seeing += cv::countNonZero(mask) > 0;
  }
  if (seeing < kFewestJudged) return {};
  agreed_ = true;
  const auto why = mattes::disagreement(cameras, masks);
  if (!why) return {};
  return Error{ErrorId::InvalidArgument,
               nameOf(frame) + *why +
                   "; check that camera's matte, calibration and synchronisation, leave it out (--leave-out NAME), "
                   "or go on all the same (--any-silhouettes; --mattes-alone: cameras do not help each other)"};
}

}  // namespace fourdvt::reconstruct
