// SPDX-License-Identifier: Apache-2.0
// Work of a tracking run in its folder, in files that are written atomically: pictures of the frames, cropped once and
// read often; their thumbnails; the template; fitted frames. A file of other settings counts as absent.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "capture/folder/result_folder.h"
#include "track/figures.h"
#include "track/fit.h"
#include "track/order.h"
#include "track/template.h"

namespace fourdvt::track {

// One frame of a sequence, as a number over all sequences.
struct FrameList {
  explicit FrameList(const capture::Capture& capture) {
    for (const capture::CaptureSequence& sequence : capture.sequences) {
      starts.push_back(count);
      count += sequence.frame_count;
    }
  }
  uint32_t sequenceOf(uint32_t frame) const {
    uint32_t s = uint32_t(starts.size()) - 1;
    while (starts[s] > frame) --s;
    return s;
  }
  std::vector<uint32_t> starts;  // [sequence] its first frame
  uint32_t count = 0;
};

struct FramePictures {
  std::vector<View> views;
};

// Frame that was looked at for the template.
struct JudgedFrame {
  uint32_t frame = 0;  // FrameList
  double score = 0;
};

// Template and the frame that it was made of.
struct ChosenTemplate {
  uint32_t frame = 0;  // FrameList
  TemplateMesh mesh;
  TemplateFitness fitness;
  std::vector<JudgedFrame> judged;
};

struct TrackedFrame {
  FittedFrame fit;
  FitFigures figures;
  double seconds = 0;
};

class Work {
 public:
  // `key`: settings of the run.
  Work(const capture::ResultFolder& folder, const capture::Capture& capture, const std::string& key);

  Status makeFolders() const;
  const FrameList& frames() const { return frames_; }
  std::string nameOf(uint32_t frame) const;  // "walk, frame 12"

  bool hasPictures(uint32_t frame) const;  // with thumbnails
  Status save(uint32_t frame, const FramePictures& pictures, const FrameThumbnails& thumbnails) const;
  Result<FramePictures> pictures(uint32_t frame) const;
  Result<FrameThumbnails> thumbnails(uint32_t frame) const;

  std::optional<ChosenTemplate> chosenTemplate() const;
  Status save(const ChosenTemplate& chosen) const;

  std::optional<TrackedFrame> tracked(uint32_t frame) const;
  // Errors: InvalidArgument (not fitted).
  Result<TrackedFrame> requireTracked(uint32_t frame) const;
  Status save(uint32_t frame, const TrackedFrame& tracked) const;
  // Repairs replace the fits of the tree in tracked(). They stay in memory: each process begins them anew, so that an
  // interrupted run ends with the same bytes.
  void setRepair(uint32_t frame, TrackedFrame tracked) { repairs_[frame] = std::move(tracked); }

 private:
  std::string path(const char* kind, uint32_t frame) const;

  std::string folder_;
  std::vector<std::string> names_;  // [sequence]
  FrameList frames_;
  std::map<uint32_t, TrackedFrame> repairs_;
};

}  // namespace fourdvt::track
