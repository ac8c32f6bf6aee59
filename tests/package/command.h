// SPDX-License-Identifier: Apache-2.0
// Runs the programs as a user would and checks their output. Scratch folders are emptied when they are created.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fourdvt::test {

struct Outcome {
  int code = -1;       // exit code; 128 + signal if killed
  std::string output;  // stdout and stderr
};

// Runs a shell command line.
Outcome shell(const std::string& command);
// Runs fourdvt with these arguments.
Outcome fourdvt(const std::string& arguments);
// Runs fourdvt-lab with these arguments.
Outcome lab(const std::string& arguments);
// Runs the program, and sends Ctrl-C once the file `once_there` exists, or a file of this name below its folder. The
// output passes through the file `log`.
Outcome interrupted(const std::string& program, const std::string& arguments, const std::string& once_there,
                    const std::string& log);
// True if the output is one line that ends in a newline and contains `part`.
bool isOneLineWith(const Outcome& outcome, const std::string& part);

// Creates an empty folder of this name in the build tree, separate from those of other test programs.
std::string scratch(const std::string& name);
// Capture by make_small_capture; `rig`: its argument.
std::string smallCapture(const std::string& name, int frames = 6, const std::string& rig = "");
std::string copyOf(const std::string& folder, const std::string& name);
// The only file with this extension (".mp4") in the folder.
std::string onlyFile(const std::string& folder, const std::string& extension);

std::string readText(const std::string& path);
void writeText(const std::string& path, const std::string& text);
void truncateTo(const std::string& path, double share);
// Overwrites `count` bytes at `offset` with 0xA5.
void damage(const std::string& path, uint64_t offset, uint64_t count);
bool exists(const std::string& path);
// Names of the files of a folder that differ between two folders or are missing in one, without report.* files.
std::vector<std::string> differences(const std::string& a, const std::string& b);

}  // namespace fourdvt::test
