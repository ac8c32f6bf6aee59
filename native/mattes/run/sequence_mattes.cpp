// SPDX-License-Identifier: Apache-2.0
#include "mattes/run/sequence_mattes.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/parallel.h"
#include "capture/matte_flaw.h"
#include "mattes/reduced.h"

namespace fourdvt::mattes {

Result<SequenceMattes> SequenceMattes::open(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                            const std::vector<MatteSource>& sources, const JointMattes& joint,
                                            const Strokes& strokes, const OpenVideo& open_video) {
  SequenceMattes out(capture, sources, joint);
  for (const capture::CaptureCamera& camera : capture.cameras) {
    FOURDVT_ASSIGN(auto pictures,
                   capture::MattedPictures::open(sequence, camera, open_video, capture::MatteNeed::Required));
    out.pictures_.push_back(std::move(pictures));
  }
  out.strokes_ = strokes;
  out.hints_.resize(capture.cameras.size());
  return out;
}

// First frame to read: hints are tracked from the last strokes before `frame`.
uint32_t SequenceMattes::firstToRead(size_t camera, uint32_t frame) const {
  if (!hints_[camera].idle()) return next_;
  const auto& strokes = strokes_[camera];
  auto after = strokes.upper_bound(frame);
  uint32_t first = frame;
  if (after != strokes.begin() && (--after)->first >= next_) first = after->first;
  const auto earliest = strokes.lower_bound(next_);  // strokes in between hold as long as the latest ones
  if (earliest != strokes.end() && earliest->first < first) first = earliest->first;
  return first;
}

Status SequenceMattes::readCamera(size_t camera, uint32_t frame, MatteView& view) {
  const capture::CaptureCamera& calibrated = capture_->cameras[camera];
  for (uint32_t at = firstToRead(camera, frame); at <= frame; ++at) {
    FOURDVT_ASSIGN(auto read, pictures_[camera].read(at));
    view.picture = std::move(read.colour);
    view.given = std::move(read.matte);
    const auto stroke = strokes_[camera].find(at);
    const bool has = stroke != strokes_[camera].end();
    if (has || !hints_[camera].idle()) hints_[camera].advance(view.picture, has ? &stroke->second : nullptr);
  }
  view.hints = hints_[camera].cost();
  if (!made(camera)) {
    view.given_is_final = true;
    return {};
  }
  const MatteSource& source = (*sources_)[camera];
  if (source.from_clip) {
    view.plates = &*source.from_clip;
    view.fit_plates = false;
    view.colours = &source.clip.colours;
    const Image small = reduced(view.picture, reductionFor(calibrated, kClipPixels));
    cv::resize(costOfTheUsual(source.clip, small), view.more_cost, {view.picture.width, view.picture.height}, 0, 0,
               cv::INTER_LINEAR);
  } else if (source.key->natural()) {
    view.plates = &source.key->model();
  } else {
    view.given = source.key->matte(view.picture);
  }
  return {};
}

Status SequenceMattes::checkPlates(const MattesFrame& frame) {
  if (std::exchange(checked_, true)) return {};
  for (size_t i = 0; i < frame.mattes.size(); ++i) {
    const auto& key = (*sources_)[i].key;
    if (!made(i) || !key) continue;
    // Uses the camera's own key: joint mattes would hide a plate that does not fit.
    const cv::Mat& own = frame.mattes[i].own;
    Image key_alone(own.cols, own.rows, 1);
    std::copy(own.begin<uint8_t>(), own.end<uint8_t>(), key_alone.pixels.begin());
    if (capture::keepsTheBorder(key_alone) || frame.mattes[i].residual_levels > kMaxResidual)
      return plateDoesNotFit(key->path(), pictures_[i].path(), capture_->cameras[i].pinhole.name);
  }
  return {};
}

Result<MattesFrame> SequenceMattes::make(uint32_t frame) {
  std::vector<MatteView> views(pictures_.size());
  std::vector<Status> done(pictures_.size());
  inParallel(views.size(), [&](size_t i) { done[i] = readCamera(i, frame, views[i]); });
  for (const Status& status : done)
    if (!status.ok()) return status.error();
  next_ = frame + 1;
  MattesFrame out;
  out.mattes = joint_->make(views);
  for (MatteView& view : views) out.pictures.push_back(std::move(view.picture));
  FOURDVT_TRY(checkPlates(out));
  return out;
}

}  // namespace fourdvt::mattes
