// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <optional>

#include "lab/measure/surface_score.h"
#include "lab/tools/commands.h"
#include "lab/tools/progress.h"
#include "package/character.h"
#include "tools/args.h"
#include "tools/session.h"

namespace fourdvt::lab {
namespace {

const tools::CommandHelp& help() {
  static const tools::CommandHelp text{
      "surfaces CAPTURE [--reference CAPTURE2]",
      "Scores the capture's surfaces, of any topology: by plain projective texturing from its videos at the held-out "
      "cameras, and by distance to the surfaces of a reference capture.",
      {{"--sequences", "A,B", "only these sequences (default: all)"},
       {"--reference", "CAPTURE2", "the same motions with the true surfaces"},
       {"--closest", "M",
        "texture on the GPU from the M cameras nearest to the view, 0: all (default: on the CPU from all)"}}};
  return text;
}

struct Arguments {
  std::string capture, reference;
  std::vector<std::string> sequences;
  std::optional<int> closest;
};

Status score(const Arguments& arguments) {
  const auto open = [&](const std::string& folder) {
    return capture::openCapture(folder, tools::videoOpener(), arguments.sequences, capture::MeshNeed::AnySurface);
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
  const auto scores = measure::scoreSurfaces(capture, reference ? &*reference : nullptr, tools::videoOpener(),
                                             {gpu ? gpu->device.get() : nullptr, arguments.closest.value_or(0)}, line);
  line.end();
  if (!scores) return scores.error();
  std::fputs(measure::surfaceTable(scores.value()).c_str(), stdout);
  return {};
}

}  // namespace

int surfacesCommand(int argc, char** argv) {
  tools::Args args(help(), argc, argv);
  Arguments arguments;
  arguments.capture = args.positional();
  arguments.sequences = args.list("--sequences");
  arguments.reference = args.text("--reference");
  if (args.has("--closest")) arguments.closest = args.integer("--closest", 0, 0, package::kMaxCameras);
  if (const auto code = tools::helpOrProblem(help(), args)) return *code;
  const Status scored = score(arguments);
  return scored.ok() ? tools::kOk : tools::fail(scored.error());
}

}  // namespace fourdvt::lab
