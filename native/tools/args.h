// SPDX-License-Identifier: Apache-2.0
// A strict command line: declared options only, every value checked, and the first problem is kept as one line.
// Order of calls: construct → read every option → problem(). Does NOT exit or print.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::tools {

// The program that messages name; "fourdvt" until it is set.
const char* programName();
void setProgramName(const char* name);

constexpr int kOk = 0, kFailed = 1, kUsage = 2, kInterrupted = 130;

struct Option {
  const char* name;      // "--layers", or a short one such as "-o"
  const char* value;     // how the help calls the value; nullptr: the option is a flag
  const char* meaning;   // with default and unit; the help breaks it into lines
  bool repeats = false;  // may be given several times
};

struct CommandHelp {
  const char* usage;    // "bake CAPTURE -o CHARACTER [options]"
  const char* summary;  // one or two sentences; the help breaks them into lines
  std::vector<Option> options;
  const char* instead = nullptr;  // an option that takes the positional argument's place
  const char* second = nullptr;   // what a second positional argument is, such as "CAMERA"; none: there is one only
};

class Args {
 public:
  // `argv` after the command's name. Exactly one positional argument is expected, or two with CommandHelp::second,
  // unless --help or CommandHelp::instead is given. Sets the log level (log.h).
  Args(const CommandHelp& help, int argc, char** argv);

  bool wantsHelp() const { return help_asked_; }
  const std::string& positional() const { return positional_; }
  const std::string& second() const { return second_; }
  bool has(const char* name) const { return values_.count(name) > 0; }
  std::string text(const char* name, const std::string& otherwise = {}) const;
  std::vector<std::string> texts(const char* name) const;  // of an option that repeats
  std::string required(const char* name);
  int integer(const char* name, int otherwise, int low, int high);
  double number(const char* name, double otherwise, double low, double high);
  std::vector<std::string> list(const char* name);  // comma-separated, no empty entries
  // Such as "720x960", each side from 1 to `high`.
  std::optional<std::pair<int, int>> size(const char* name, int high);
  void complain(const std::string& problem);               // keeps the first problem
  const std::string& problem() const { return problem_; }  // empty if there is none
  // The command line with the options that were read, defaults too.
  std::string resolved() const;

 private:
  std::map<std::string, std::vector<std::string>> values_;  // that were given
  mutable std::map<std::string, std::string> resolved_;     // that were read
  std::string positional_, second_, problem_;
  bool help_asked_ = false;
};

std::string helpText(const CommandHelp& help);
// Prints the help or the problem and returns kOk or kUsage; nullopt if the command may run.
std::optional<int> helpOrProblem(const CommandHelp& help, const Args& args);
// Prints "PROGRAM: MESSAGE" and returns the exit code of the error.
int fail(const Error& error);

}  // namespace fourdvt::tools
