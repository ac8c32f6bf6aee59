// SPDX-License-Identifier: Apache-2.0
#include "edge/motion.h"

#include <cmath>
#include <cstdlib>

#include "base/text.h"
#include "edge/opencv_flow.h"

namespace fourdvt::edge {
namespace {

std::optional<double> number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

Result<render::Align> prepareAlign(AlignMethod method, gpu::Device& device, render::Recipe& recipe) {
  if (method == AlignMethod::None) return render::Align::None;
  if (method == AlignMethod::Baked) return render::Align::Baked;
  render::FlowOptions options;
  if (method == AlignMethod::FlowDis || method == AlignMethod::FlowOpencvDis) options.method = render::FlowMethod::Dis;
  if (method == AlignMethod::FlowOpencv || method == AlignMethod::FlowOpencvDis) {
    recipe.setFlow(createOpencvFlow(device, options));
  } else {
    FOURDVT_ASSIGN(auto flow, render::createGpuFlow(device, options));
    recipe.setFlow(std::move(flow));
  }
  return render::Align::Flow;
}

Status setParameters(Player& player, const Parameters& parameters, const std::string& character) {
  for (const auto& [name, value] : parameters)
    if (Status status = player.setParameter(name, value, true); !status.ok())
      return Error{status.error().id, character + ": " + status.error().message};
  return {};
}

std::optional<std::pair<std::string, double>> parseParameter(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) return std::nullopt;
  const auto value = number(text.substr(equals + 1));
  if (!value) return std::nullopt;
  return std::pair{text.substr(0, equals), *value};
}

std::optional<Cue> parseCue(const std::string& text) {
  const size_t at = text.rfind('@');
  if (at == std::string::npos) return text.empty() ? std::nullopt : std::optional(Cue{text, 0});
  const auto seconds = number(text.substr(at + 1));
  if (at == 0 || !seconds || *seconds < 0) return std::nullopt;
  return Cue{text.substr(0, at), *seconds};
}

std::optional<Sweep> parseSweep(const std::string& text) {
  const size_t equals = text.find('='), colon = text.find(':', equals);
  if (equals == std::string::npos || equals == 0 || colon == std::string::npos) return std::nullopt;
  const auto from = number(text.substr(equals + 1, colon - equals - 1)), to = number(text.substr(colon + 1));
  if (!from || !to) return std::nullopt;
  return Sweep{text.substr(0, equals), *from, *to};
}

Result<const package::Sequence*> findState(const package::Character& character, const std::string& name,
                                           const std::string& folder) {
  if (const package::Sequence* found = character.find(name)) return found;
  const std::string known = joined(character.sequences, ", ", &package::Sequence::name);
  return Error{ErrorId::InvalidArgument, folder + ": has no sequence \"" + name + "\"; it has " + known};
}

}  // namespace fourdvt::edge
