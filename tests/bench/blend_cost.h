// SPDX-License-Identifier: Apache-2.0
// Cost of motion::blendFrame, for the benches of the native and the wasm build (node).
#pragma once

#include <algorithm>
#include <cmath>
#include <ctime>

#ifdef __EMSCRIPTEN__
#include <emscripten.h>
#endif

#include "motion/blend.h"

namespace fourdvt::bench {

// Processor time, ms: hardly affected by other processes.
#ifdef __EMSCRIPTEN__
EM_JS(double, benchNow_ms, (), {  // in node std::clock returns wall time
  const used = process.cpuUsage();
  return (used.user + used.system) / 1000;
});
inline double now_ms() { return benchNow_ms(); }
#else
inline double now_ms() { return 1e3 * double(std::clock()) / CLOCKS_PER_SEC; }
#endif

// Milliseconds per call: the minimum of several runs, since other processes only add time.
inline double blendCost_ms(const package::ChunkFrames& frames, uint32_t row, const package::StreamIndex& index,
                           const motion::BlendWeights& weights) {
  constexpr int kRuns = 9, kBlends = 1000;
  Positions out;
  double least = HUGE_VAL;
  for (int run = 0; run < kRuns; ++run) {
    const double start = now_ms();
    for (int i = 0; i < kBlends; ++i) motion::blendFrame(frames, row, index, weights, out);
    least = std::min(least, (now_ms() - start) / kBlends);
  }
  return least;
}

}  // namespace fourdvt::bench
