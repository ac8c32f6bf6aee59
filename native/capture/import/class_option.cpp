// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "capture/capture_json.h"
#include "capture/import/import_capture.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

Error wrong(const std::string& what) { return {ErrorId::InvalidArgument, "--class " + what}; }

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> out;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(separator, begin), text.size());
    out.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

// Parses SEQUENCE or SEQUENCE:VALUE/VALUE.
Result<CaptureClass::MemberOf> parseMember(const std::string& text, const CaptureClass& owner) {
  const size_t colon = text.find(':');
  CaptureClass::MemberOf out{text.substr(0, colon), {}};
  if (out.sequence.empty()) return wrong(owner.name + ": a name of a sequence is missing before \"" + text + "\"");
  if (colon == std::string::npos && toNumber<double>(text))
    return wrong(owner.name + ": \"" + text + "\" is no sequence; write decimals with a point, like walk:1.2");
  if (colon == std::string::npos) return out;
  for (const std::string& word : split(text.substr(colon + 1), '/')) {
    const auto value = toNumber<double>(word);
    if (!value || !std::isfinite(*value))
      return wrong(owner.name + ": \"" + word + "\" of \"" + out.sequence + "\" is no number; write it like 1.2");
    out.parameter.push_back(*value);
  }
  return out;
}

// Checks that every member has a value of every parameter, or that none has and the bake measures the only parameter.
Status checkValues(const CaptureClass& given) {
  const auto bare = [](const CaptureClass::MemberOf& member) { return member.parameter.empty(); };
  const auto& members = given.members;
  const bool measured = given.parameters.size() == 1 && given.parameters[0] == kMeasuredParameter;
  if (measured && std::all_of(members.begin(), members.end(), bare)) return {};
  for (const CaptureClass::MemberOf& member : members) {
    if (member.parameter.size() == given.parameters.size()) continue;
    const std::string one = given.parameters.size() == 1 ? ":1.2" : ":1.2/0";
    return wrong(given.name + ": \"" + member.sequence + "\" has " + std::to_string(member.parameter.size()) +
                 " values of " + std::to_string(given.parameters.size()) + "; give one for each parameter, like " +
                 member.sequence + one + (measured ? ", or leave all out: the bake measures the speed" : ""));
  }
  return {};
}

}  // namespace

Result<CaptureClass> parseClassOption(const std::string& text) {
  const size_t equals = text.find('='), colon = text.find(':');
  if (equals == std::string::npos || colon == std::string::npos || colon == 0 || colon + 1 >= equals)
    return wrong(
        "must be NAME:PARAMETER=SEQUENCE:VALUE,SEQUENCE:VALUE, like locomotion:speed_mps=walk:1.2,run:2.7; "
        "\"" +
        text + "\" is not");
  CaptureClass out;
  out.name = text.substr(0, colon);
  out.parameters = split(text.substr(colon + 1, equals - colon - 1), ',');
  for (const std::string& entry : split(text.substr(equals + 1), ',')) {
    FOURDVT_ASSIGN(auto member, parseMember(entry, out));
    out.members.push_back(std::move(member));
  }
  if (out.members.size() < kMinMembers || out.members.size() > kMaxMembers)
    return wrong(out.name + ": a class joins " + std::to_string(kMinMembers) + " to " + std::to_string(kMaxMembers) +
                 " sequences, not " + std::to_string(out.members.size()));
  FOURDVT_TRY(checkValues(out));
  return out;
}

std::string classProblem(const std::vector<CaptureClass>& classes, const std::vector<std::string>& sequences,
                         const std::vector<std::string>& loops) {
  std::vector<DeclaredSequence> declared(sequences.size());
  for (size_t i = 0; i < sequences.size(); ++i) {
    declared[i].sequence.name = sequences[i];
    declared[i].sequence.loop = std::find(loops.begin(), loops.end(), sequences[i]) != loops.end();
  }
  const auto parsed = parseClasses(classesJson(classes), declared, "--class");
  return parsed.ok() ? std::string() : parsed.error().message;
}

}  // namespace fourdvt::capture
