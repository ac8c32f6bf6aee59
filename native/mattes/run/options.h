// SPDX-License-Identifier: Apache-2.0
// Options of `fourdvt mattes`, and its environment: videos, progress, interruption.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/video.h"
#include "base/watch.h"

namespace fourdvt::mattes {

struct MattesOptions {
  std::string capture_folder, folder;  // read, written
  std::vector<std::string> sequences;  // empty: all
  std::vector<std::string> leave_out;  // cameras
  bool alone = false;                  // every camera by itself
  bool any_silhouettes = false;        // continue although no common volume explains the silhouettes
  int preview = 0;                     // frames per sequence, without a capture; 0: all frames
  int jobs = 0;                        // threads; 0: one per core
  bool resume = false;
};

struct MattesEnvironment {
  OpenVideo open_video;
  std::function<void(const FrameProgress&)> progress;
  const std::atomic<bool>* stop = nullptr;  // set by Ctrl-C: finishes the frame and keeps finished work
};

}  // namespace fourdvt::mattes
