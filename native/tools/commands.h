// SPDX-License-Identifier: Apache-2.0
// A program made of subcommands, with help and version; the subcommands of `fourdvt`, each of which parses, checks,
// calls the library and returns the exit code (args.h); and the option rows that several of them share
// (common_options.cpp).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "tools/args.h"

namespace fourdvt::bake {
struct BakeOptions;
}
namespace fourdvt::capture {
struct CaptureClass;
}
namespace fourdvt::refine {
struct RefineOptions;
}
namespace fourdvt::track {
struct TrackOptions;
}

namespace fourdvt::tools {

struct Command {
  const char* name;
  const char* summary;
  // Takes the arguments after the command's name and returns the exit code; null: not in this build.
  Result<int> (*run)(int argc, char** argv);
};

// Runs the command named by argv[1]. Exceptions of libraries end in a message and kFailed.
int runProgram(const char* program, std::span<const Command> commands, int argc, char** argv);

// Additional options of another program.
using BakeExtension = Options (*)(bake::BakeOptions&);
using TrackExtension = Options (*)(track::TrackOptions&);

Result<int> importCommand(int argc, char** argv);
Result<int> calibrateCommand(int argc, char** argv);
Result<int> mattesCommand(int argc, char** argv);
Result<int> reconstructCommand(int argc, char** argv);
Result<int> trackCommand(int argc, char** argv, TrackExtension extension = nullptr);
Result<int> bakeCommand(int argc, char** argv, BakeExtension extension = nullptr);
Result<int> planCommand(int argc, char** argv);
Result<int> pieceCommand(int argc, char** argv);
Result<int> finishCommand(int argc, char** argv);
Result<int> jobCommand(int argc, char** argv);
Result<int> inspectCommand(int argc, char** argv);
Result<int> renderCommand(int argc, char** argv);
Result<int> liveCommand(int argc, char** argv);
Result<int> liveCameraCommand(int argc, char** argv);

// Returns true for a folder with a capture.json.
bool isCaptureFolder(const std::string& path);
// Prints, per sequence and camera, the pictures of a capture, their files' marks and the conversions applied, and the
// source of mattes. Returns the command's exit code: 1 if a file cannot be used.
Result<int> inspectCapture(const std::string& folder);

// Motion classes, for the programs with the importer.
Option classOption(std::vector<capture::CaptureClass>& field);
Option sequencesOption(std::vector<std::string>& field);
Option jobsOption(int& field, const std::string& what = "worker threads");
Option resumeOption(bool& field);
// Selects the rendition to draw; values as in findRendition (session.h).
Option renditionOption(std::optional<int>& field);

// Refinement of a capture's meshes and cameras against its pictures.
Options refineOptions(refine::RefineOptions& options);
bool refinesExplicitly(const Args& args);  // true if any of them is given

}  // namespace fourdvt::tools
