// SPDX-License-Identifier: Apache-2.0
// Command lines of `fourdvt bake`, `fourdvt reconstruct` and `fourdvt track`, shared with `fourdvt plan`, and the
// environments of their pieces.
#pragma once

#include <optional>
#include <string>

#include "bake/bake.h"
#include "reconstruct/run/reconstruct.h"
#include "tools/commands.h"
#include "tools/session.h"
#include "tools/terminal.h"
#include "track/run/track.h"

namespace fourdvt::tools {

// Sets the options. A value is the exit code: help or a problem was printed.
Result<std::optional<int>> readBakeCommand(int argc, char** argv, bake::BakeOptions& options,
                                           BakeExtension extension = nullptr);
// Borrows both arguments; installs the Ctrl-C handler.
bake::BakeEnvironment bakeEnvironment(const GpuSession& gpu, ProgressLine& line);
void printBakeSummary(const std::string& character_folder, const bake::BakeReport& report, double seconds);

std::optional<int> readReconstructCommand(int argc, char** argv, reconstruct::ReconstructOptions& options);
// Borrows both arguments; installs the Ctrl-C handler. A session without a device suffices if stereo is off.
reconstruct::ReconstructEnvironment reconstructEnvironment(const GpuSession& gpu, ProgressLine& line);
void printReconstructSummary(const std::string& folder, const reconstruct::ReconstructSummary& summary);

// Checks the classes against the input's sequences, too.
Result<std::optional<int>> readTrackCommand(int argc, char** argv, track::TrackOptions& options,
                                            TrackExtension extension = nullptr);
// Borrows the line; installs the Ctrl-C handler.
track::TrackEnvironment trackEnvironment(ProgressLine& line);
void printTrackSummary(const std::string& folder, const track::TrackSummary& summary);

}  // namespace fourdvt::tools
