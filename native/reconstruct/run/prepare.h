// SPDX-License-Identifier: Apache-2.0
// The serial part of a reconstruction, before its frames: the capture is opened, cameras are left out, the new folder
// is linked to it, cameras are put in step and in place, mattes that are missing are made. One process does it, and
// every frame needs all of it. Does NOT make surfaces.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "capture/folder/result_folder.h"
#include "reconstruct/run/options.h"
#include "refine/run/calibrate_capture.h"

namespace fourdvt::reconstruct {

// Limit on the threads of OpenCV and OpenVDB while it lives; 0: none.
class Threads {
 public:
  explicit Threads(int count);
  ~Threads();

 private:
  struct Limit;
  std::unique_ptr<Limit> limit_;
};

// A reconstruction up to its frames.
struct Prepared {
  ReconstructOptions options;         // folders absolute, sequences named
  std::string settings_key;           // one line: what decides how frames come out
  std::vector<std::string> warnings;  // one line each
  std::string name;                   // of the capture that is read
  capture::Capture capture;           // the new folder, which frames are read from, under that name

  // The user's folder of a sequence, for messages.
  std::string folderOf(const std::string& sequence) const { return options.capture_folder + "/" + sequence; }
};

capture::ResultFolder resultFolder(const ReconstructOptions& options);

// Work that an earlier run left in the same place.
enum class Earlier {
  Removed,
  Kept,       // or refused, if it is of other settings
  KeptIfSame  // removed with a note, if it is of other settings
};

class Preparation {
 public:
  // Borrows the environment.
  Preparation(const ReconstructOptions& options, const ReconstructEnvironment& environment)
      : environment_(environment), given_folder_(options.capture_folder) {
    out_.options = options;
  }

  // Everything but mattes. Errors: those of openCapture; InvalidArgument (folders, names, work of other settings);
  // WriteFailed; Interrupted.
  Status link(Earlier earlier);
  // The new folder, once it is linked.
  const capture::Capture& capture() const { return out_.capture; }
  bool wantsMattes() const { return wants_mattes_; }
  // Makes the mattes that are missing, cameras together; colour keys are made as frames are read. Errors: those of
  // mattes::addMattes.
  Status addMattes();
  Prepared take() { return std::move(out_); }

 private:
  Status openGiven();
  Status linkFrames();
  Status calibrate();

  const ReconstructEnvironment& environment_;
  const std::string given_folder_;  // as the user calls it
  Prepared out_;
  capture::Capture given_;  // later with the new one's cameras and times
  bool wants_mattes_ = false;
  std::optional<refine::Calibration> calibration_;  // made by this run
};

}  // namespace fourdvt::reconstruct
