// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "lab/measure/drift_report.h"
#include "lab/tools/commands.h"
#include "lab/tools/progress.h"
#include "platform/files.h"
#include "tools/args.h"
#include "tools/commands.h"

namespace fourdvt::lab {
namespace {

struct Arguments {
  std::string tracked, reference, json;
  measure::DriftOptions drift;
};

// "walk:12"
std::optional<measure::FrameOfSequence> parseFrame(const std::string& text) {
  const size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size() || text.size() - colon > 9 ||
      text.find_first_not_of("0123456789", colon + 1) != std::string::npos)
    return std::nullopt;
  return measure::FrameOfSequence{text.substr(0, colon), uint32_t(std::stoul(text.substr(colon + 1)))};
}

Status score(const Arguments& arguments) {
  const auto open = [](const std::string& folder) {
    return capture::openDescription(folder, {}, capture::MeshNeed::ConstantTopology);
  };
  FOURDVT_ASSIGN(const auto tracked, open(arguments.tracked));
  FOURDVT_ASSIGN(const auto reference, open(arguments.reference));
  const FrameLine line;
  FOURDVT_ASSIGN(const auto report, measure::measureDrift(tracked, reference, arguments.drift, line));
  line.end();
  std::fputs(measure::driftTable(report).c_str(), stdout);
  if (arguments.json.empty()) return {};
  return platform::writeFileAtomic(arguments.json, measure::driftJson(report));
}

}  // namespace

Result<int> driftCommand(int argc, char** argv) {
  Arguments a;
  const tools::Args args(
      {"drift TRACKED --reference TRUTH [options]",
       "Measures how far the vertices of tracked meshes drift over a reference of the same motions whose vertices are "
       "material points. Each vertex is bound to the reference's surface in one frame; its error is the distance from "
       "that place, along the surface (tangential) and along its normal. Change is the root mean square, over the "
       "vertices, of the error's change from a frame to the next.",
       {&a.tracked},
       {{"--reference TRUTH", tools::required(a.reference), "the capture with the true motion (required)"},
        tools::sequencesOption(a.drift.sequences),
        {"--frame SEQ:N", tools::parsed(a.drift.bind_at, parseFrame, "SEQUENCE:NUMBER"),
         "bind at frame N of sequence SEQ (default: the template of TRACKED/track.json, else the first frame)"},
        {"--within-mm X", tools::number(a.drift.limits.within_m, 0.001, 100'000, 1e-3),
         "leave out vertices farther than X from the reference there (default 15)"},
        {"--json FILE", tools::text(a.json), "also write the figures, with those of each frame"}}},
      argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  FOURDVT_TRY(score(a));
  return tools::kOk;
}

}  // namespace fourdvt::lab
