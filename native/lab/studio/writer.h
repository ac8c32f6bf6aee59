// SPDX-License-Identifier: Apache-2.0
// Output of a studio capture: progress and stop, and the atomically renamed folder.
#pragma once

#include <string>

#include "lab/studio/actors/actor.h"
#include "lab/studio/studio.h"

namespace fourdvt::studio {

// FOLDER.work, renamed to FOLDER by keep(); otherwise the destructor removes it with its contents.
class OutputFolder {
 public:
  // Errors: InvalidArgument (FOLDER exists and is no studio capture, or FOLDER.work exists and is not ours),
  // WriteFailed.
  static Result<OutputFolder> open(const std::string& folder);
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&&) = delete;
  ~OutputFolder();
  const std::string& path() const { return work_; }
  Status makeFolder(const std::string& name) const;
  Status keep();

 private:
  OutputFolder(std::string folder, std::string work) : folder_(std::move(folder)), work_(std::move(work)) {}
  std::string folder_, work_;
};

class Ticker {
 public:
  Ticker(const StudioEnvironment& environment, uint32_t total) : environment_(environment) { progress_.total = total; }
  void begin(const std::string& step) { progress_.step = step; }
  Status tick();  // counts one finished picture. Errors: Interrupted
  uint32_t done() const { return progress_.done; }

 private:
  const StudioEnvironment& environment_;
  StudioProgress progress_;
};

}  // namespace fourdvt::studio
