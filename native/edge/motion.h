// SPDX-License-Identifier: Apache-2.0
// Textual motion parameters, cues and alignment, shared by the command line and scene files.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "player/player.h"

namespace fourdvt::edge {

// Alignment of a class's members and of a transition's two states; see render::Align.
enum class AlignMethod { None, Baked, FlowGpu, FlowDis, FlowOpencv, FlowOpencvDis };
// Sets up the optical flow for the method in the recipe. Errors: Unsupported (no float render targets).
Result<render::Align> prepareAlign(AlignMethod method, gpu::Device& device, render::Recipe& recipe);

using Parameters = std::vector<std::pair<std::string, double>>;
// Errors: InvalidArgument (no class of the character has such a parameter). `character` is used in the message.
Status setParameters(Player& player, const Parameters& parameters, const std::string& character);

struct Cue {  // transition to a state at a time
  std::string state;
  double at_s = 0;
};
struct Sweep {
  std::string parameter;
  double from = 0, to = 0;
};
std::optional<std::pair<std::string, double>> parseParameter(const std::string& text);  // NAME=VALUE
std::optional<Cue> parseCue(const std::string& text);                                   // STATE@SECONDS, or STATE: at 0
std::optional<Sweep> parseSweep(const std::string& text);                               // NAME=FROM:TO

// Finds the sequence or class of this name. Errors: InvalidArgument, whose message lists the names.
Result<const package::Sequence*> findState(const package::Character& character, const std::string& name,
                                           const std::string& folder);

}  // namespace fourdvt::edge
