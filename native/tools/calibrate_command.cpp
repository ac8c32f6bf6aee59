// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "refine/run/calibrate_capture.h"
#include "refine/run/calibration_report.h"
#include "tools/args.h"
#include "tools/choice.h"
#include "tools/commands.h"
#include "tools/log.h"
#include "tools/session.h"
#include "tools/stop_signal.h"

namespace fourdvt::tools {
namespace {

const CommandHelp& help() {
  static const CommandHelp text{
      "calibrate CAPTURE [-o CAPTURE2] [options]",
      "Compares every camera's silhouettes with the visual hull of all others: names cameras that are off in time, by "
      "how many frames, and turns cameras that stand wrongly. Needs mattes or plates, and no mesh. With -o: writes a "
      "capture folder with \"offset_frames\" and a calibration of its own, all else being links into CAPTURE; without: "
      "only prints. `fourdvt reconstruct` does the same before it makes surfaces. What all cameras share is not seen: "
      "which of them is on time, and how the whole rig stands. The report is CAPTURE2/calibrate.html.",
      {{"-o", "CAPTURE2", "folder to write"},
       {"--sequences", "A,B", "only these sequences (default: all)"},
       {"--leave-out", "A,B", "cameras that take no part, and that the new capture shall not have"},
       {"--synchronise", "MODE", "on (default): find offsets in time; off: keep them as they are"},
       {"--refine-cameras", "MODE",
        "on (default): turn cameras that the silhouettes clearly contradict; off: as given"},
       {"--most-offset", "N", "most frames that a camera may be off, 1 to 100 (default 8)"},
       {"--jobs", "N", "worker threads; 0: one per core (default 0)"}}};
  return text;
}

refine::CalibrateOptions readOptions(Args& args) {
  refine::CalibrateOptions o;
  o.capture_folder = args.positional();
  o.folder = args.text("-o");
  o.sequences = args.list("--sequences");
  o.leave_out = args.list("--leave-out");
  o.calibration.times = choice(args, "--synchronise", true, {{"on", true}, {"off", false}});
  o.calibration.cameras = choice(args, "--refine-cameras", true, {{"on", true}, {"off", false}});
  o.calibration.most_frames = args.integer("--most-offset", o.calibration.most_frames, 1, 100);
  o.jobs = args.integer("--jobs", 0, 0, 1024);
  if (!o.calibration.times && !o.calibration.cameras)
    args.complain("--synchronise off and --refine-cameras off leave nothing to do");
  return o;
}

}  // namespace

int calibrateCommand(int argc, char** argv) {
  Args args(help(), argc, argv);
  const refine::CalibrateOptions options = readOptions(args);
  if (const auto code = helpOrProblem(help(), args)) return *code;
  const std::atomic<bool>* stop = listenForStop();
  const bool tty = rewritesProgress();
  const auto calibration = refine::calibrateCapture(options, videoOpener(), [&](const std::string& what, double share) {
    if (tty) std::fprintf(stderr, "\r\033[K%s %.0f %%", what.c_str(), 100 * share);
    return !*stop;
  });
  if (tty) std::fputs("\r\033[K", stderr);
  if (!calibration.ok()) return fail(calibration.error());
  for (const std::string& warning : calibration.value().warnings) warn("%s", warning.c_str());
  for (const std::string& line : refine::calibrationLines(calibration.value())) std::printf("%s\n", line.c_str());
  if (!options.folder.empty()) note("figures: %s/%s", options.folder.c_str(), refine::kCalibrationHtml);
  return kOk;
}

}  // namespace fourdvt::tools
