// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "refine/run/calibrate_capture.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

Options rows(refine::CalibrateOptions& o) {
  refine::CalibrationOptions& calibration = o.calibration;
  return {
      {"-o CAPTURE2", text(o.folder), "folder to write"},
      sequencesOption(o.sequences),
      {"--leave-out A,B", list(o.leave_out), "cameras that take no part, and that the new capture shall not have"},
      {"--synchronise MODE", choice(calibration.times, {{"on", true}, {"off", false}}),
       "on (default): find offsets in time; off: keep them as they are"},
      {"--refine-cameras MODE", choice(calibration.cameras, {{"on", true}, {"off", false}}),
       "on (default): turn cameras that the silhouettes clearly contradict; off: as given"},
      {"--most-offset N", number(calibration.max_frames, 1, 100),
       "most frames that a camera may be off, 1 to 100 (default 8)"},
      jobsOption(o.jobs),
  };
}

}  // namespace

Result<int> calibrateCommand(int argc, char** argv) {
  refine::CalibrateOptions options;
  Args args({"calibrate CAPTURE [-o CAPTURE2] [options]",
             "Compares every camera's silhouettes with the visual hull of all others: names cameras that are off in "
             "time, by how many frames, and turns cameras that stand wrongly. Needs mattes or plates, and no mesh. "
             "With -o: writes a capture folder with \"offset_frames\" and a calibration of its own, all else being "
             "links into CAPTURE; without: only prints. `fourdvt reconstruct` does the same before it makes surfaces. "
             "What all cameras share is not seen: which of them is on time, and how the whole rig stands. The report "
             "is CAPTURE2/calibrate.html.",
             {&options.capture_folder},
             rows(options)},
            argc, argv);
  if (!options.calibration.times && !options.calibration.cameras)
    args.complain("--synchronise off and --refine-cameras off leave nothing to do");
  if (const auto code = args.helpOrProblem()) return *code;
  const std::atomic<bool>* stop = listenForStop();
  const bool tty = rewritesProgress();
  const auto calibration = refine::calibrateCapture(options, videoOpener(), [&](const std::string& what, double share) {
    if (tty) std::fprintf(stderr, "\r\033[K%s %.0f %%", what.c_str(), 100 * share);
    return !*stop;
  });
  if (tty) std::fputs("\r\033[K", stderr);
  if (!calibration.ok()) return calibration.error();
  for (const std::string& warning : calibration.value().warnings) warn("%s", warning.c_str());
  for (const std::string& line : refine::calibrationLines(calibration.value())) std::printf("%s\n", line.c_str());
  if (!options.folder.empty()) note("figures: %s/%s", options.folder.c_str(), refine::kCalibrationHtml);
  return kOk;
}

}  // namespace fourdvt::tools
