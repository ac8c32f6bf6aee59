// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "lab/measure/held_out.h"
#include "lab/tools/commands.h"
#include "lab/tools/progress.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::lab {
namespace {

struct Arguments {
  std::string character, capture, output, method;
  std::optional<int> closest, rendition;
  measure::HeldOutOptions held_out;
};

tools::Options rows(Arguments& a) {
  using namespace tools;
  a.held_out.flicker_cameras = 1;
  return {
      {"--capture CAPTURE", required(a.capture), "the capture that CHARACTER was baked from (required)"},
      {"-o FOLDER", text(a.output), "also write evaluate.csv, evaluate.txt and worst.png"},
      sequencesOption(a.held_out.sequences),
      renditionOption(a.rendition),
      {"--method NAME", text(a.method),
       "drawing method; for characters from layers: montage4d (default: the plain blend)"},
      {"--closest M", number(a.closest, 0, package::kMaxCameras),
       "for characters from cameras: number of cameras that a view uses, 0: all (default 4)"},
      {"--input-every N", number(a.held_out.input_every, 0, 1'000'000),
       "score input cameras at every Nth frame, 0: never (default 4)"},
      {"--flicker N", number(a.held_out.flicker_cameras, 0, package::kMaxCameras),
       "measure flicker at N input cameras, in levels of 255, 0: none (default 1); needs constant topology"},
      {"--yardstick", flag(a.held_out.yardstick),
       "also score plain projective texturing of the given mesh, without layers or codec"},
  };
}

Status writeReport(const std::string& folder, const measure::HeldOutReport& report) {
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/evaluate.csv", measure::scoreCsv(report)));
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/evaluate.txt", measure::scoreTable(report)));
  if (report.worst.empty()) return {};
  return platform::writeImage(folder + "/worst.png", measure::contactSheet(report.worst));
}

Status score(const Arguments& arguments) {
  if (!arguments.output.empty()) FOURDVT_TRY(platform::makeFolder(arguments.output));
  FOURDVT_ASSIGN(auto session, tools::openCharacter(arguments.character, arguments.rendition));
  if (!arguments.method.empty()) FOURDVT_TRY(tools::useMethod(session, arguments.method));
  if (arguments.closest) session.player->player().setMethod({.closest = *arguments.closest});
  FOURDVT_ASSIGN(auto capture, mattes::openCapture(arguments.capture, tools::videoOpener(),
                                                   arguments.held_out.sequences, capture::MeshNeed::AnySurface));
  const FrameLine line;
  FOURDVT_ASSIGN(const auto report,
                 measure::evaluateHeldOut(capture, tools::videoOpener(), *session.player, arguments.held_out, line));
  line.end();
  std::fputs(measure::scoreTable(report).c_str(), stdout);
  const bool follows = capture.meshes == capture::CaptureMeshes::ConstantTopology;
  if (arguments.held_out.flicker_cameras > 0 && !follows)
    tools::note("flicker is not measured: meshes of per-frame topology do not show where a point goes");
  return arguments.output.empty() ? Status() : writeReport(arguments.output, report);
}

}  // namespace

Result<int> scoreCommand(int argc, char** argv) {
  Arguments arguments;
  const tools::Args args(
      {"score CHARACTER --capture CAPTURE [options]",
       "Scores a baked character against its capture: PSNR (RGB) and SSIM (luma, 11x11 Gaussian) over the union of "
       "both "
       "silhouettes, on black, at held-out and input cameras; by sequence, by camera, and the mean. \"common dB\" is "
       "the PSNR over the intersection of both silhouettes, which excludes errors of the outline. Flicker is the "
       "change "
       "on the surface from one picture to the next: of the error at an input camera, and of the colours on a slow "
       "orbit.",
       {&arguments.character},
       rows(arguments)},
      argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  FOURDVT_TRY(score(arguments));
  return tools::kOk;
}

}  // namespace fourdvt::lab
