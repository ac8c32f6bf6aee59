// SPDX-License-Identifier: Apache-2.0
#include "mattes/run/mattes.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

Options rows(mattes::MattesOptions& o) {
  return {
      {"-o CAPTURE2", required(o.folder), "folder to write (required)"},
      sequencesOption(o.sequences),
      {"--preview N", number(o.preview, 1, 100),
       "only N frames of every sequence, and no capture: a report to look at before the long run, 1 to 100"},
      {"--leave-out A,B", list(o.leave_out), "cameras that the new capture shall not have"},
      {"--mattes-alone", flag(o.alone), "every camera by itself, e.g. where cameras are not synchronised"},
      {"--any-silhouettes", flag(o.any_silhouettes),
       "go on although no common volume explains the silhouettes of the first frame"},
      jobsOption(o.jobs),
      resumeOption(o.resume),
  };
}

}  // namespace

Result<int> mattesCommand(int argc, char** argv) {
  mattes::MattesOptions options;
  Args args({"mattes CAPTURE -o CAPTURE2 [options]",
             "Makes mattes for the cameras that have none, and writes a capture folder with them: pictures are links "
             "into CAPTURE, mattes are PNG files. Each camera is keyed against its plates, or, without plates, against "
             "a background that is made from its clips; then the cameras help each other: what the others contradict "
             "is dropped, what all of them demand is filled, dark patches that lie on the floor are shadows. Strokes "
             "painted by hand in CAPTURE/hints/SEQUENCE/CAMERA/000000.png (white: performer, black: background, the "
             "rest transparent) are obeyed, and followed through later frames. `fourdvt reconstruct` does the same "
             "where mattes are missing. The folder appears when it is complete. After Ctrl-C, the same command with "
             "--resume continues. The report, with a contact sheet for every camera, is CAPTURE2/mattes.html.",
             {&options.capture_folder},
             rows(options)},
            argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  const std::atomic<bool>* stop = listenForStop();
  ProgressLine line;
  mattes::MattesEnvironment environment;
  environment.open_video = videoOpener();
  environment.progress = [&line](const FrameProgress& p) { line.show(p); };
  environment.stop = stop;
  FOURDVT_ASSIGN(const auto s, mattes::makeMattes(options, environment));
  line.end();
  for (const std::string& warning : s.warnings) warn("%s", warning.c_str());
  const uint32_t made = s.frames - s.frames_kept;
  note("%s: mattes of %u frames, %.1f s (%.2f s per frame of all cameras)", options.folder.c_str(), s.frames, s.wall_s,
       made ? s.wall_s / made : 0.0);
  note("contact sheets: %s/mattes.html", options.folder.c_str());
  return kOk;
}

}  // namespace fourdvt::tools
