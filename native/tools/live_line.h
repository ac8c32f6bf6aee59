// SPDX-License-Identifier: Apache-2.0
// Display of a command that runs until it is stopped: one line, rewritten in place on a terminal and printed anew
// elsewhere, and notes, which stay. Functions may be called on any thread.
#pragma once

#include <mutex>
#include <string>

namespace fourdvt::tools {

class LiveLine {
 public:
  LiveLine();
  void show(const std::string& line);  // standard output
  void note(const std::string& line);  // standard error, after the program's name
  void end();

 private:
  const bool tty_;
  std::mutex mutex_;
  std::string line_;  // on the terminal now
};

}  // namespace fourdvt::tools
