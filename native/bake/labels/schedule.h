// SPDX-License-Identifier: Apache-2.0
// Schedule of the windows of a sequence: their frames, their dependencies, and the number solved concurrently.
//
// Every second window ("even") starts without labels; the windows between two of them fill the gap and solve the ends
// of both neighbours again, between frozen frames. All even windows are therefore independent of each other, and so
// are all odd ones: the labels do not depend on the number of threads.
#pragma once

#include <functional>
#include <vector>

#include "bake/labels/labelling.h"

namespace fourdvt::bake {

struct LabelWindow {
  uint32_t first = 0, end = 0;              // frames whose labels it sets
  uint32_t fresh_first = 0, fresh_end = 0;  // the part of these that has no labels yet
  uint32_t frozen_first = 0,
           frozen_end = 0;  // frames that it reads: first..end and one frozen frame at either end, if any
  bool odd = false;         // depends on the windows before and after it in the list of planWindows
};

// Windows in order of time, alternately even and odd. Modes without a temporal term have one window per frame, and
// none is odd.
std::vector<LabelWindow> planWindows(const LabelOptions& options, uint32_t frame_count);

struct LabelSteps {
  std::function<Status(const LabelWindow&)> load;  // on the calling thread, before the window
  std::function<void(const LabelWindow&)> solve;   // on any thread
  std::function<Status(uint32_t frame)> finish;    // on the calling thread, frames in ascending order
};
// Errors: those of the steps; Interrupted once *stop.
Status runWindows(const std::vector<LabelWindow>& windows, uint32_t frame_count, int jobs, const LabelSteps& steps,
                  const std::atomic<bool>* stop);

}  // namespace fourdvt::bake
