// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "lab/measure/matte_score.h"
#include "lab/tools/commands.h"
#include "lab/tools/progress.h"
#include "platform/files.h"
#include "tools/args.h"
#include "tools/session.h"

namespace fourdvt::lab {
namespace {

const tools::CommandHelp& help() {
  static const tools::CommandHelp text{
      "mattes CAPTURE [--against FOLDER] [-o REPORT.json]",
      "Scores the mattes that fourdvt reads or makes from plates against the true ones of the virtual studio: by "
      "intersection over union of all pixels and of those beyond 2 pixels of the true edge, and by the edges' "
      "distance.",
      {{"--against", "FOLDER",
        "true mattes, in the capture: FOLDER/SEQUENCE/maskNN.mkv or maskNN/%06d.png (default mattes_true)"},
       {"--sequences", "A,B", "only these sequences (default: all)"},
       {"-o", "REPORT.json", "file to write the same rows to"}}};
  return text;
}

struct Arguments {
  std::string capture, against, report;
  std::vector<std::string> sequences;
};

Status score(const Arguments& arguments) {
  FOURDVT_ASSIGN(auto capture, capture::openCapture(arguments.capture, tools::videoOpener(), arguments.sequences,
                                                    capture::MeshNeed::Nothing));
  const FrameLine line;
  const auto scores =
      measure::scoreMattes(capture, capture.folder + "/" + arguments.against, tools::videoOpener(), line);
  line.end();
  if (!scores) return scores.error();
  std::fputs(measure::matteTable(scores.value()).c_str(), stdout);
  if (arguments.report.empty()) return {};
  return platform::writeFileAtomic(arguments.report, measure::matteJson(scores.value()));
}

}  // namespace

int mattesCommand(int argc, char** argv) {
  tools::Args args(help(), argc, argv);
  Arguments arguments;
  arguments.capture = args.positional();
  arguments.against = args.has("--against") ? args.text("--against") : "mattes_true";
  arguments.report = args.text("-o");
  arguments.sequences = args.list("--sequences");
  if (const auto code = tools::helpOrProblem(help(), args)) return *code;
  const Status scored = score(arguments);
  return scored.ok() ? tools::kOk : tools::fail(scored.error());
}

}  // namespace fourdvt::lab
