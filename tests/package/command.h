// SPDX-License-Identifier: Apache-2.0
// Runs the tool as a user would and looks at what came out. Scratch folders are emptied when they are made.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fourdvt::test {

struct Outcome {
  int code = -1;       // exit code; 128 + signal if killed
  std::string output;  // stdout and stderr
};

// A shell command line.
Outcome shell(const std::string& command);
// fourdvt with these arguments.
Outcome fourdvt(const std::string& arguments);
// fourdvt-lab with these arguments.
Outcome lab(const std::string& arguments);
// The program with these arguments, sent Ctrl-C once the file `once_there` exists, or one of its name below
// its folder. Its output goes through the file
// `log`.
Outcome interrupted(const std::string& program, const std::string& arguments, const std::string& once_there,
                    const std::string& log);
// One line of text that ends in a newline and contains `part`.
bool isOneLineWith(const Outcome& outcome, const std::string& part);

// An empty folder of this name in the build tree, apart from those of other test programs.
std::string scratch(const std::string& name);
// rig: make_small_capture's.
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
