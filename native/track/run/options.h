// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/video.h"
#include "base/watch.h"
#include "capture/capture.h"
#include "track/fit.h"
#include "track/template.h"

namespace fourdvt::track {

constexpr double kMinCycle_s = 0.4, kMaxCycle_s = 4;  // length of a loop that is searched

struct FrameName {
  std::string sequence;
  uint32_t frame = 0;
};

struct TrackOptions {
  std::string capture_folder, folder;       // input with surfaces, output
  std::vector<std::string> sequences;       // empty: all
  std::optional<FrameName> template_frame;  // none: chosen
  TemplateOptions mesh;
  uint32_t nodes = 400;                        // nodes in the deformation graph
  std::vector<std::string> loops;              // sequences of which one cycle becomes a loop; loops stay whole
  std::vector<capture::CaptureClass> classes;  // written to the new capture
  FitOptions fit;
  bool by_similarity = true;  // false: each frame from its predecessor in time
  int jobs = 0;               // threads; 0: one per core
  bool resume = false;
};

struct TrackEnvironment {
  OpenVideo open_video;
  std::function<void(const FrameProgress&)> progress;
  std::function<void(const std::string&)> note;  // receives one line of information; may be empty
  const std::atomic<bool>* stop = nullptr;       // set by Ctrl-C: ends after the current frame, keeping finished frames
};

}  // namespace fourdvt::track
