// SPDX-License-Identifier: Apache-2.0
#include "lab/study/study.h"
#include "lab/tools/commands.h"
#include "lab/tools/run_study.h"
#include "tools/args.h"
#include "tools/commands.h"

namespace fourdvt::lab {
Result<int> studyCommand(int argc, char** argv) {
  study::StudyOptions o;
  const tools::Args args(
      {"study CAPTURE -o REPORT [--quick]",
       "Bakes the capture by every method that is compared and writes the papers' tables and curves: "
       "REPORT/evaluate.csv, evaluate.json (the same rows) and report.html. After Ctrl-C, the same command continues.",
       {&o.capture_folder},
       tools::join({{{"-o REPORT", tools::required(o.report_folder), "folder to write (required)"},
                     tools::sequencesOption(o.sequences),
                     {"--quick", tools::flag(o.quick), "a first look: the shortest sequence, few views and settings"},
                     {"--steps A,B", tools::list(o.steps), "only these steps of the study (default: all)"},
                     {"--views N", tools::number(o.ring_views, 4, 360), "views of the ring, 4 to 360 (default 36)"},
                     tools::jobsOption(o.jobs, "worker threads of the bakes")},
                    tools::refineOptions(o.refine)})},
      argc, argv);
  if (args.has("--views")) o.further = " --views " + std::to_string(o.ring_views);
  if (const auto code = args.helpOrProblem()) return *code;
  return runStudyCommand(o, capture::MeshNeed::ConstantTopology, study::runStudy);
}

}  // namespace fourdvt::lab
