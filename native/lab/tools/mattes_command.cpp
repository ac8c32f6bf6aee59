// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "lab/measure/matte_score.h"
#include "lab/tools/commands.h"
#include "lab/tools/progress.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/session.h"

namespace fourdvt::lab {
namespace {

struct Arguments {
  std::string capture, against = "mattes_true", report;
  std::vector<std::string> sequences;
};

Status score(const Arguments& arguments) {
  FOURDVT_ASSIGN(auto capture, mattes::openCapture(arguments.capture, tools::videoOpener(), arguments.sequences,
                                                   capture::MeshNeed::Nothing));
  const FrameLine line;
  FOURDVT_ASSIGN(const auto scores,
                 measure::scoreMattes(capture, capture.folder + "/" + arguments.against, tools::videoOpener(), line));
  line.end();
  std::fputs(measure::matteTable(scores).c_str(), stdout);
  if (arguments.report.empty()) return {};
  return platform::writeFileAtomic(arguments.report, measure::matteJson(scores));
}

}  // namespace

Result<int> mattesCommand(int argc, char** argv) {
  Arguments a;
  const tools::Args args(
      {"mattes CAPTURE [--against FOLDER] [-o REPORT.json]",
       "Scores the mattes that fourdvt reads or makes from plates against the true ones of the virtual studio: by "
       "intersection over union of all pixels and of those beyond 2 pixels of the true edge, and by the edges' "
       "distance.",
       {&a.capture},
       {{"--against FOLDER", tools::text(a.against),
         "true mattes, in the capture: FOLDER/SEQUENCE/maskNN.mkv or maskNN/%06d.png (default mattes_true)"},
        tools::sequencesOption(a.sequences),
        {"-o REPORT.json", tools::text(a.report), "file to write the same rows to"}}},
      argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  FOURDVT_TRY(score(a));
  return tools::kOk;
}

}  // namespace fourdvt::lab
