// SPDX-License-Identifier: Apache-2.0
// What a bake needs from the program that runs it: a GPU, a way to open videos, a listener, a way to be stopped.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "base/video.h"
#include "gpu/device.h"
#include "refine/refine.h"

namespace fourdvt::bake {

struct Progress {
  // "warp locomotion", "survey walk 12/28", "walk 12/28", "align locomotion 12/28", "graph"
  std::string stage;
  uint32_t done = 0, total = 0;  // frames encoded in the whole bake; 0 until the survey ends
  double frames_per_s = 0, left_s = 0;
};

struct BakeEnvironment {
  gpu::Device* device = nullptr;  // GLES; current on this thread
  OpenVideo open_video;
  const refine::Refinement* refinement = nullptr;  // already known for this capture; null: the bake makes it
  std::function<void(const Progress&)> progress;
  std::function<void(const std::string&)> note;  // one line that the user should read before the work begins
  std::string writer;  // of unfinished files (RecordFile): one of its own where several processes bake at once
  const std::atomic<bool>* stop = nullptr;  // set by Ctrl-C: finish the frame, keep finished GOPs, return Interrupted
};

}  // namespace fourdvt::bake
