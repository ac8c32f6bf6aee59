// SPDX-License-Identifier: Apache-2.0
// The place of a capture folder that a command is making until all of it is there, beside the folder that is to be
// written:
//   CAPTURE2.part   the capture folder that is being made
//   CAPTURE2.work   the settings it is made with, and figures of finished frames
// Nothing is put into place before finish(). Does NOT know what the command makes.
#pragma once

#include <string>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::capture {

// One of the commands that write capture folders.
struct FolderWriter {
  std::string command;   // "reconstruct"
  std::string marker;    // a file that every folder of its has, "reconstruct.json"
  std::string not_with;  // a file that none of its folders has, though another command's folder with the marker may
};

// Absolute, without links. Errors: InvalidArgument if `folder` and the capture that is read lie in each other, or if
// `folder` holds something that the command has not written.
Result<std::string> checkedTarget(const std::string& folder, const std::string& capture_folder,
                                  const FolderWriter& writer);

// A hash of what a capture's frames are made from: calibration, and names, sizes and times of pictures, mattes, plates
// and hints. 16 hexadecimal digits.
std::string inputsKey(const Capture& capture);

// Name of a frame's file without its ending: "000012".
std::string frameName(uint32_t frame);

class ResultFolder {
 public:
  // `target`: see checkedTarget.
  ResultFolder(std::string target, FolderWriter writer) : target_(std::move(target)), writer_(std::move(writer)) {}
  std::string partFolder() const { return target_ + ".part"; }
  std::string workFolder() const { return target_ + ".work"; }

  // Work that an earlier run left stays only with `resume`. `key`: text of the settings that frames depend on. Errors:
  // InvalidArgument (left with another key, or not left by this command), WriteFailed.
  Status open(const std::string& key, bool resume) const;
  // True where an earlier run left work with this key.
  bool holds(const std::string& key) const;
  // The part takes the target's place; the work folder stays. On failure all work is still kept.
  Status place() const;
  // The same, and the work folder is removed.
  Status finish() const;

 private:
  std::string signature() const { return "by " + writer_.command + "\n"; }

  std::string target_;
  FolderWriter writer_;
};

}  // namespace fourdvt::capture
