// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "lab/study/projective/method_scores.h"
#include "lab/study/projective/projective_study.h"
#include "lab/tools/commands.h"
#include "lab/tools/progress.h"
#include "lab/tools/run_study.h"
#include "mattes/frame_reader.h"
#include "package/character.h"
#include "render/cameras/camera_method.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/session.h"

namespace fourdvt::lab {
namespace {

struct Arguments {
  study::StudyOptions study;
  study::MethodScoreOptions table;
};

std::string optionsAsTyped(const study::StudyOptions& options) {
  std::string out;
  for (const std::string& method : options.methods)
    out += (&method == &options.methods.front() ? " --methods " : ",") + method;
  if (options.test_frames > 1) out += " --frames " + std::to_string(options.test_frames);
  return out + (options.axis_frames > 0 ? " --axis-frames " + std::to_string(options.axis_frames) : "");
}

tools::Options rows(Arguments& a) {
  using namespace tools;
  study::StudyOptions& study = a.study;
  render::MethodOptions& method = a.table.method;
  return {
      {"-o REPORT", text(study.report_folder), "folder to write"},
      sequencesOption(study.sequences),
      {"--methods A,B", list(study.methods), "only these methods (default: all)"},
      {"--frames N", number(study.test_frames, 1, 10'000),
       "with -o: test frames of each sequence, spread over it (default 1)"},
      {"--axis-frames N", number(study.axis_frames, 1, 10'000),
       "with -o: the same of conditions that no choice is made on, then without flicker and times (default: as "
       "--frames)"},
      {"--steps A,B", list(study.steps), "with -o: only these steps of the report (default: all)"},
      {"--quick", flag(study.quick), "a first look: few views and conditions"},
      {"--closest M", number(method.closest, 0, package::kMaxCameras),
       "without -o: number of cameras that a view uses, 0: all (default 4)"},
      {"--sweep-planes N", number(method.sweep.planes, 4, 32),
       "without -o, method sweep: depth hypotheses for each pixel, 4 to 32 in steps of 4 (default 12)"},
      {"--sweep-band-mm X", number(method.sweep.band_m, 0.1, 1000, 1e-3),
       "without -o, method sweep: depth range behind the surface (default 32)"},
  };
}

void check(tools::Args& args, const study::StudyOptions& study) {
  if (study.report_folder.empty()) {
    for (const char* name : {"--frames", "--axis-frames", "--steps"})
      if (args.has(name)) args.complain(std::string(name) + " needs -o REPORT");
  } else {
    for (const char* name : {"--closest", "--sweep-planes", "--sweep-band-mm"})
      if (args.has(name))
        args.complain(std::string(name) + " does not go with -o: the report has conditions of its own");
  }
}

Status printTable(Arguments& arguments) {
  FOURDVT_ASSIGN(auto capture, mattes::openCapture(arguments.study.capture_folder, tools::videoOpener(),
                                                   arguments.study.sequences, capture::MeshNeed::AnySurface));
  FOURDVT_ASSIGN(auto gpu, tools::openGpu());
  study::MethodScoreOptions& options = arguments.table;
  if (options.methods.empty()) options.methods = render::cameraMethodNames(render::MethodGroup::Textured);
  const FrameLine line;
  FOURDVT_ASSIGN(const auto scores, study::scoreMethods(*gpu.device, capture, tools::videoOpener(), options, line));
  line.end();
  std::fputs(study::methodTable(scores).c_str(), stdout);
  return {};
}

}  // namespace

Result<int> methodsCommand(int argc, char** argv) {
  Arguments arguments;
  study::StudyOptions& study = arguments.study;
  study.command = "methods";
  study.stem = "projective";
  tools::Args args(
      {"methods CAPTURE [-o REPORT] [--methods A,B] [--quick]",
       "Compares the methods of characters from cameras (fourdvt render --method), drawn from the raw "
       "videos.\nWith -o: on the capture's surfaces, coarser ones, hulls and a plane, by number of cameras "
       "and with calibration errors; writes REPORT/projective.csv, projective.json (the same rows) and "
       "report.html. After Ctrl-C, the same command continues. Without -o: prints one table for the "
       "capture's surfaces.",
       {&study.capture_folder},
       rows(arguments)},
      argc, argv);
  check(args, study);
  if (const auto code = args.helpOrProblem()) return *code;
  arguments.table.quick = study.quick;
  arguments.table.methods = study.methods;
  study.further = optionsAsTyped(study);
  if (!arguments.study.report_folder.empty())
    return runStudyCommand(arguments.study, capture::MeshNeed::AnySurface, study::runProjectiveStudy);
  FOURDVT_TRY(printTable(arguments));
  return tools::kOk;
}

}  // namespace fourdvt::lab
