// SPDX-License-Identifier: Apache-2.0
// Mattes of one sequence, frame by frame: reads pictures, hints and given mattes as filmed, and makes the mattes of all
// cameras jointly. Holds one frame in memory and writes no files.
#pragma once

#include <optional>
#include <vector>

#include "capture/matted_pictures.h"
#include "mattes/hints.h"
#include "mattes/joint_mattes.h"
#include "mattes/run/matte_sources.h"

namespace fourdvt::mattes {

struct MattesFrame {
  std::vector<Image> pictures;  // RGB
  std::vector<CameraMatte> mattes;
};

class SequenceMattes {
 public:
  // All arguments must outlive the result. Errors: those of pictures.
  static Result<SequenceMattes> open(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                     const std::vector<MatteSource>& sources, const JointMattes& joint,
                                     const Strokes& strokes, const OpenVideo& open_video);
  // Makes frames in ascending order; hints of skipped frames are tracked. Errors: those of pictures; FileUnreadable
  // where a plate does not fit the first keyed picture.
  Result<MattesFrame> make(uint32_t frame);
  bool made(size_t camera) const {
    return !pictures_[camera].hasMattes();
  }  // false: the capture has this camera's mattes

 private:
  SequenceMattes(const capture::Capture& capture, const std::vector<MatteSource>& sources, const JointMattes& joint)
      : capture_(&capture), sources_(&sources), joint_(&joint) {}
  Status readCamera(size_t camera, uint32_t frame, MatteView& view);
  Status checkPlates(const MattesFrame& frame);
  uint32_t firstToRead(size_t camera, uint32_t frame) const;

  const capture::Capture* capture_;
  const std::vector<MatteSource>* sources_;
  const JointMattes* joint_;
  std::vector<capture::MattedPictures> pictures_;  // [camera]
  Strokes strokes_;
  std::vector<HintTrack> hints_;
  uint32_t next_ = 0;
  bool checked_ = false;
};

}  // namespace fourdvt::mattes
