// SPDX-License-Identifier: Apache-2.0
#include "lab/study/study.h"
#include "lab/tools/commands.h"
#include "lab/tools/run_study.h"
#include "tools/args.h"
#include "tools/refine_arguments.h"

namespace fourdvt::lab {
namespace {

const tools::CommandHelp& help() {
  static const tools::CommandHelp text{
      "study CAPTURE -o REPORT [--quick]",
      "Bakes the capture by every method that is compared and writes the papers' tables and curves: "
      "REPORT/evaluate.csv, evaluate.json (the same rows) and report.html. After Ctrl-C, the same command continues.",
      {{"-o", "REPORT", "folder to write (required)"},
       {"--sequences", "A,B", "only these sequences (default: all)"},
       {"--quick", nullptr, "a first look: the shortest sequence, few views and settings"},
       {"--steps", "A,B", "only these steps of the study (default: all)"},
       {"--views", "N", "views of the ring, 4 to 360 (default 36)"},
       {"--jobs", "N", "worker threads of the bakes; 0: one per core (default 0)"},
       tools::kRefineOption,
       tools::kRefineCamerasOption,
       tools::kMatteBiasOption}};
  return text;
}

}  // namespace

int studyCommand(int argc, char** argv) {
  tools::Args args(help(), argc, argv);
  study::StudyOptions options;
  options.capture_folder = args.positional();
  options.report_folder = args.required("-o");
  options.sequences = args.list("--sequences");
  options.quick = args.has("--quick");
  options.steps = args.list("--steps");
  options.ring_views = args.integer("--views", options.ring_views, 4, 360);
  if (args.has("--views")) options.further = " --views " + std::to_string(options.ring_views);
  options.jobs = args.integer("--jobs", 0, 0, 1024);
  options.refine = tools::readRefineOptions(args);
  if (const auto code = tools::helpOrProblem(help(), args)) return *code;
  return runStudyCommand(options, capture::MeshNeed::ConstantTopology, study::runStudy);
}

}  // namespace fourdvt::lab
