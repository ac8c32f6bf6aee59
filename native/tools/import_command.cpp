// SPDX-License-Identifier: Apache-2.0
#include "capture/import/import_capture.h"
#include "capture/import/readers.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

Options rows(capture::ImportOptions& o) {
  using capture::Orientation;
  const auto readSequences = [&o](Args& args, const std::string& name) {
    for (const std::string& entry : args.list(name)) {
      const size_t equals = entry.find('=');
      o.sequences.emplace_back(entry.substr(0, equals), equals == std::string::npos ? "" : entry.substr(equals + 1));
    }
  };
  return {
      {"-o CAPTURE", required(o.folder), "folder to write (required); it must not exist"},
      {"--up AXIS", parsed(o.up, capture::axisNamed, "X, -X, Y, -Y, Z or -Z"),
       "X, -X, Y, -Y, Z or -Z: the axis of the calibration that points up, which becomes Y (default: what the format "
       "defines, else Y)"},
      {"--scale S", number(o.metres_per_unit, 1e-6, 1e6),
       "metres per unit of the calibration, 1e-6 to 1e6 (default: what the format defines, else 1)"},
      {"--cropped", flag(o.cropped),
       "pictures that are smaller than calibrated lack columns at the right and rows at the bottom (default: an "
       "error)"},
      {"--orientation marked|stored",
       choice(o.orientation, {{"marked", Orientation::Marked}, {"stored", Orientation::Stored}}),
       "the calibration is of pictures as players show them, or as they lie in the file, where files mark them as "
       "turned or mirrored (default: by size; an error where both fit)"},
      {"--fps X", number(o.fps, 0.01, 1000), "frames a second (default: that of the videos, else 25)"},
      {"--ignore-time-codes", flag(o.ignore_time_codes),
       "clips begin together, as after cutting them by a clap (default: by their time codes, if all have one)"},
      {"--sequences A=DIR,...", readSequences,
       "names of the sequences, and the folders in SOURCE that hold their videos (default: one, called take, of "
       "SOURCE itself)"},
      {"--loop A,B", list(o.loops), "sequences whose frame after the last one is the first (default: none)"},
      classOption(o.classes),
  };
}

}  // namespace

Option classOption(std::vector<capture::CaptureClass>& field) {
  const auto read = [&field](Args& args, const std::string& name) {
    for (const std::string& text : args.texts(name)) {
      auto given = capture::parseClassOption(text);
      if (given.ok())
        field.push_back(given.take());
      else
        args.complain(given.error().message);
    }
  };
  return {"--class C:P=A:V,B:W", read,
          "sequences A and B become one motion C with the parameter P, which has the value V in A and W in B, like "
          "locomotion:speed_mps=walk:1.2,run:2.7; without values the bake measures speed_mps. Two parameters: "
          "C:P,Q=A:V/X,B:W/Y. May be given several times",
          true};
}

Result<int> importCommand(int argc, char** argv) {
  capture::ImportOptions options;
  Args args({"import SOURCE -o CAPTURE [options]",
             "Makes a capture folder from a calibration of another program and the videos or pictures beside it, which "
             "are linked. SOURCE is a folder, or the calibration file. Videos are found by the cameras' names: "
             "CAMERA.mp4 (.mkv, .mov, .avi, .webm), CAMERA/ with numbered pictures or one picture; plates as "
             "CAMERA/background.png or .avi, background/CAMERA.png and the like; mattes in masks/, meshes in mesh/. "
             "Calibrations: " +
                 capture::knownCalibrations() + ". What is not found is printed.",
             {&options.source},
             rows(options)},
            argc, argv);
  args.complain(options.check());
  if (const auto code = args.helpOrProblem()) return *code;
  FOURDVT_ASSIGN(const auto summary, capture::importCapture(options, videoOpener()));
  for (const std::string& warning : summary.warnings) warn("%s", warning.c_str());
  for (const std::string& line : summary.details) detail("%s", line.c_str());
  for (const std::string& line : summary.done) note("%s", line.c_str());
  note("%s is written", options.folder.c_str());
  return kOk;
}

}  // namespace fourdvt::tools
