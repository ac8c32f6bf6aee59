// SPDX-License-Identifier: Apache-2.0
// Temporary location of a capture folder that a command writes, beside the target:
// CAPTURE2.part   the capture folder in progress
// CAPTURE2.work   its settings, and figures of finished frames
// The target is unchanged until place() or finish().
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::capture {

// Command that writes capture folders.
struct FolderWriter {
  std::string command;   // "reconstruct"
  std::string marker;    // name of a file in every folder of this command, "reconstruct.json"
  std::string not_with;  // name of a file never in this command's folders, but in another's with the same marker
};

// Absolute path without links. Errors: InvalidArgument if `folder` and the input capture contain one another, or if
// `folder` has contents of another origin.
Result<std::string> checkedTarget(const std::string& folder, const std::string& capture_folder,
                                  const FolderWriter& writer);

// Hash of a capture's inputs: calibration, and names, sizes and times of pictures, mattes, plates and hints. 16
// hexadecimal digits.
std::string inputsKey(const Capture& capture);

// Name of a frame's file without extension: "000012".
std::string frameName(uint32_t frame);

// Handling of an earlier run's work in the same folders.
enum class Earlier {
  Removed,
  Kept,       // error if its settings differ
  KeptIfSame  // for a plan: removed with a note if its settings differ
};

class ResultFolder {
 public:
  // `target`: see checkedTarget.
  ResultFolder(std::string target, FolderWriter writer) : target_(std::move(target)), writer_(std::move(writer)) {}
  // Variant whose part this process alone writes, where several may write the same result at once.
  ResultFolder ofThisProcess() const;
  std::string partFolder() const { return target_ + part_ending_; }
  std::string workFolder() const { return target_ + ".work"; }

  // Keeps the work of an earlier run only with `resume`. `key`: text of the settings that frames depend on. Errors:
  // InvalidArgument (work of another key, or of another command), WriteFailed.
  Status open(const std::string& key, bool resume) const;
  // Calls open() for a command that runs in one process or in pieces (jobs/plan.h), and returns the key: settings, and
  // the build where machines share the work. `note` may be empty. Errors: those of open(); InvalidArgument (Kept: a
  // plan of another build).
  Result<std::string> openFor(const std::string& settings, Earlier earlier,
                              const std::function<void(const std::string&)>& note) const;
  // Returns true where an earlier run left work with this key.
  bool holds(const std::string& key) const;
  // Moves the part to the target, also while other processes do so; the work folder stays. On failure all work is kept.
  Status place() const;
  // Calls place() and removes the work folder.
  Status finish() const;

 private:
  std::string signature() const { return "by " + writer_.command + "\n"; }

  std::string target_, part_ending_ = ".part";
  FolderWriter writer_;
};

}  // namespace fourdvt::capture
