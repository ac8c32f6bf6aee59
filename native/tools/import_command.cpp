// SPDX-License-Identifier: Apache-2.0
#include "capture/import/calibration_files.h"
#include "capture/import/class_option.h"
#include "capture/import/import_capture.h"
#include "tools/args.h"
#include "tools/choice.h"
#include "tools/commands.h"
#include "tools/log.h"
#include "tools/session.h"

namespace fourdvt::tools {
namespace {

const CommandHelp& help() {
  static const std::string summary =
      "Makes a capture folder from a calibration of another program and the videos or pictures beside it, which are "
      "linked. SOURCE is a folder, or the calibration file. Videos are found by the cameras' names: CAMERA.mp4 (.mkv, "
      ".mov, .avi, .webm), CAMERA/ with numbered pictures or one picture; plates as CAMERA/background.png or .avi, "
      "background/CAMERA.png and the like; mattes in masks/, meshes in mesh/. Calibrations: " +
      capture::knownCalibrations() + ". What is not found is printed.";
  static const CommandHelp text{
      "import SOURCE -o CAPTURE [options]",
      summary.c_str(),
      {{"-o", "CAPTURE", "folder to write (required); it must not exist"},
       {"--up", "AXIS",
        "X, -X, Y, -Y, Z or -Z: the axis of the calibration that points up, which becomes Y (default: "
        "what the format defines, else Y)"},
       {"--scale", "S", "metres per unit of the calibration, 1e-6 to 1e6 (default: what the format defines, else 1)"},
       {"--cropped", nullptr,
        "pictures that are smaller than calibrated lack columns at the right and rows at the bottom (default: an "
        "error)"},
       {"--orientation", "marked|stored",
        "the calibration is of pictures as players show them, or as they lie in the file, where files mark them as "
        "turned or mirrored (default: by size; an error where both fit)"},
       {"--fps", "X", "frames a second (default: that of the videos, else 25)"},
       {"--ignore-time-codes", nullptr,
        "clips begin together, as after cutting them by a clap (default: by their time codes, if all have one)"},
       {"--sequences", "A=DIR,...",
        "names of the sequences, and the folders in SOURCE that hold their videos (default: one, called take, of "
        "SOURCE itself)"},
       {"--loop", "A,B", "sequences whose frame after the last one is the first (default: none)"},
       {"--class", "C:P=A:V,B:W",
        "sequences A and B become one motion C with the parameter P, which has the value V in A and W in B, like "
        "locomotion:speed_mps=walk:1.2,run:2.7; without values the bake measures speed_mps. Two parameters: "
        "C:P,Q=A:V/X,B:W/Y. May be given several times",
        true}}};
  return text;
}

capture::ImportOptions readOptions(Args& args) {
  capture::ImportOptions o;
  o.source = args.positional();
  o.folder = args.required("-o");
  if (args.has("--up")) {
    o.up = capture::axisNamed(args.text("--up"));
    if (!o.up) args.complain("--up must be X, -X, Y, -Y, Z or -Z");
  }
  if (args.has("--scale")) o.metres_per_unit = args.number("--scale", 1, 1e-6, 1e6);
  if (args.has("--fps")) o.fps = args.number("--fps", 25, 0.01, 1000);
  using capture::Orientation;
  o.orientation = choice(args, "--orientation", Orientation::BySize,
                         {{"marked", Orientation::Marked}, {"stored", Orientation::Stored}});
  o.cropped = args.has("--cropped");
  o.ignore_time_codes = args.has("--ignore-time-codes");
  for (const std::string& entry : args.list("--sequences")) {
    const size_t equals = entry.find('=');
    o.sequences.emplace_back(entry.substr(0, equals), equals == std::string::npos ? "" : entry.substr(equals + 1));
  }
  o.loops = args.list("--loop");
  for (const std::string& text : args.texts("--class")) {
    auto given = capture::parseClassOption(text);
    if (given.ok())
      o.classes.push_back(given.take());
    else
      args.complain(given.error().message);
  }
  return o;
}

}  // namespace

int importCommand(int argc, char** argv) {
  Args args(help(), argc, argv);
  const capture::ImportOptions options = readOptions(args);
  if (const std::string wrong = options.check(); args.problem().empty() && !args.wantsHelp() && !wrong.empty())
    args.complain(wrong);
  if (const auto code = helpOrProblem(help(), args)) return *code;
  const auto summary = capture::importCapture(options, videoOpener());
  if (!summary.ok()) return fail(summary.error());
  for (const std::string& warning : summary.value().warnings) warn("%s", warning.c_str());
  for (const std::string& line : summary.value().details) detail("%s", line.c_str());
  for (const std::string& line : summary.value().done) note("%s", line.c_str());
  note("%s is written", options.folder.c_str());
  return kOk;
}

}  // namespace fourdvt::tools
