// SPDX-License-Identifier: Apache-2.0
// fourdvt import: a capture folder from a calibration of another program and the pictures beside it. Pictures are
// linked, never copied; clips of the empty studio are decoded to a few plates. Calibration accuracy is not checked.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/video.h"
#include "capture/import/imported.h"

namespace fourdvt::capture {

struct ImportOptions {
  std::string source;                     // folder, or a calibration file with the pictures beside it
  std::string folder;                     // output; must not exist, or be empty
  std::optional<WorldAxis> up;            // none: as defined by the format, else Y
  std::optional<double> metres_per_unit;  // none: as defined by the format, else 1
  bool cropped = false;                   // pictures may lack columns at the right and rows at the bottom
  Orientation orientation = Orientation::BySize;
  double fps = 0;                  // 0: rate of the videos, else 25
  bool ignore_time_codes = false;  // videos begin together, regardless of time codes
  // [name of a sequence, its folder in `source`]; empty: one called "take", of `source` itself
  std::vector<std::pair<std::string, std::string>> sequences;
  std::vector<std::string> loops;     // names of sequences that are loops
  std::vector<CaptureClass> classes;  // classes of these sequences
  std::string check() const;          // first problem, or empty
};

struct ImportSummary {
  std::vector<std::string> done;      // findings and rotations, one line each
  std::vector<std::string> warnings;  // gaps and assumptions, each with a remedy
  std::vector<std::string> details;   // skipped parts without effect
};

// Imports a capture; the folder appears when complete. Errors: those of readCalibration; CameraMissingVideo (no camera
// has pictures), FrameSize (both sizes are named), VideoTooShort (no instant common to all clips), WriteFailed,
// InvalidArgument (the folder is not empty), and those of findMeshes and of `open_video`.
Result<ImportSummary> importCapture(const ImportOptions& options, const OpenVideo& open_video);

// Option --class of `fourdvt import`: a class of capture.json on one line (class_option.cpp). Parses
// NAME:PARAMETER=SEQUENCE:VALUE,SEQUENCE:VALUE, such as locomotion:speed_mps=walk:1.2,run:2.7; with two parameters
// NAME:P,Q=SEQUENCE:VALUE/VALUE,…. Values are optional for speed_mps, which the bake measures. Errors: InvalidArgument.
Result<CaptureClass> parseClassOption(const std::string& text);

// Describes the first problem of classes with these sequences and loops; empty: none.
std::string classProblem(const std::vector<CaptureClass>& classes, const std::vector<std::string>& sequences,
                         const std::vector<std::string>& loops);

}  // namespace fourdvt::capture
