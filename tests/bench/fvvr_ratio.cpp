// SPDX-License-Identifier: Apache-2.0
// bench_fvvr_ratio CHARACTER CAPTURE [FRAMES [CLOSEST]]: LVDT 4.4, frame rates of the layered character and of
// free-viewpoint rendering from all cameras and from the CLOSEST (3) nearest ones, with the parts of a frame.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "lab/study/steps/frame_rate.h"
#include "mattes/frame_reader.h"
#include "or_stop.h"
#include "platform/egl_context.h"
#include "platform/ffmpeg_video.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::orStop;

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: bench_fvvr_ratio CHARACTER CAPTURE [FRAMES [CLOSEST]]\n"), 2;
  const OpenVideo open_video = [](const std::string& path, int channels) {
    return platform::openVideoFile(path, channels);
  };
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const auto capture = orStop(mattes::openCapture(argv[2], open_video));
  study::FrameRateOptions options;
  if (argc > 3) options.frames = std::max(1, std::atoi(argv[3]));
  if (argc > 4) options.closest = {0, std::max(0, std::atoi(argv[4]))};
  std::fputs(
      study::frameRateTable(orStop(study::measureFrameRates(*device, capture, open_video, argv[1], options))).c_str(),
      stdout);
  return 0;
}
