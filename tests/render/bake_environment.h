// SPDX-License-Identifier: Apache-2.0
// Environment of a test's bake: the test's device, FFmpeg's videos, a stop flag, a progress listener.
#pragma once

#include <atomic>
#include <functional>
#include <utility>

#include "bake/run/options.h"
#include "platform/ffmpeg_video.h"

namespace fourdvt::bake {

inline BakeEnvironment testEnvironment(gpu::Device& device, const std::atomic<bool>& stop,
                                       std::function<void(const FrameProgress&)> progress) {
  BakeEnvironment environment;
  environment.device = &device;
  environment.open_video = platform::openVideoFile;
  environment.stop = &stop;
  environment.progress = std::move(progress);
  return environment;
}

}  // namespace fourdvt::bake
