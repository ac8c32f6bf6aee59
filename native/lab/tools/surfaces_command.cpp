// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <optional>

#include "lab/measure/surface_score.h"
#include "lab/tools/commands.h"
#include "lab/tools/progress.h"
#include "mattes/frame_reader.h"
#include "package/character.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/session.h"

namespace fourdvt::lab {
namespace {

struct Arguments {
  std::string capture, reference;
  std::vector<std::string> sequences;
  std::optional<int> closest;
};

Status score(const Arguments& arguments) {
  const auto open = [&](const std::string& folder) {
    return mattes::openCapture(folder, tools::videoOpener(), arguments.sequences, capture::MeshNeed::AnySurface);
  };
  FOURDVT_ASSIGN(auto capture, open(arguments.capture));
  std::optional<capture::Capture> reference;
  if (!arguments.reference.empty()) {
    FOURDVT_ASSIGN(reference, open(arguments.reference));
  }
  std::optional<tools::GpuSession> gpu;
  if (arguments.closest) {
    FOURDVT_ASSIGN(gpu, tools::openGpu());
  }
  const FrameLine line;
  FOURDVT_ASSIGN(const auto scores,
                 measure::scoreSurfaces(capture, reference ? &*reference : nullptr, tools::videoOpener(),
                                        {gpu ? gpu->device.get() : nullptr, arguments.closest.value_or(0)}, line));
  line.end();
  std::fputs(measure::surfaceTable(scores).c_str(), stdout);
  return {};
}

}  // namespace

Result<int> surfacesCommand(int argc, char** argv) {
  Arguments a;
  const tools::Args args(
      {"surfaces CAPTURE [--reference CAPTURE2]",
       "Scores the capture's surfaces, of any topology: by plain projective texturing from its videos at the held-out "
       "cameras, and by distance to the surfaces of a reference capture.",
       {&a.capture},
       {tools::sequencesOption(a.sequences),
        {"--reference CAPTURE2", tools::text(a.reference), "the same motions with the true surfaces"},
        {"--closest M", tools::number(a.closest, 0, package::kMaxCameras),
         "texture on the GPU from the M cameras nearest to the view, 0: all (default: on the CPU from all)"}}},
      argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  FOURDVT_TRY(score(a));
  return tools::kOk;
}

}  // namespace fourdvt::lab
