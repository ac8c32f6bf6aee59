// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "capture/capture_json.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

using Json = nlohmann::json;
constexpr size_t kMaxParameters = 2;
constexpr double kMaxValue = 1e6;

// Reads a number or a list of numbers; false for anything else.
bool readNumbers(const Json& node, std::vector<double>& out) {
  const Json list = node.is_array() ? node : Json::array({node});
  for (const Json& value : list) {
    if (!value.is_number() || !(std::abs(value.get<double>()) <= kMaxValue)) return false;
    out.push_back(value.get<double>());
  }
  return true;
}

class ClassParser {
 public:
  ClassParser(const std::vector<DeclaredSequence>& sequences, const std::string& file)
      : sequences_(sequences), file_(file) {}

  Result<std::vector<CaptureClass>> parse(const Json& list) {
    if (list.is_null()) return std::move(classes_);
    if (!list.is_array())
      return Error{ErrorId::CaptureJson, file_ + ": \"classes\" must be a list of objects; remove or correct it"};
    for (const Json& entry : list) FOURDVT_TRY(parseClass(entry));
    return std::move(classes_);
  }

 private:
  Error error(const std::string& what) const {
    return {ErrorId::CaptureJson, file_ + ": class \"" + current_.name + "\" " + what};
  }

  const CaptureSequence* find(const std::string& name) const {
    for (const DeclaredSequence& declared : sequences_) {
      if (declared.sequence.name == name) return &declared.sequence;
    }
    return nullptr;
  }

  Status parseClass(const Json& node) {
    current_ = {};
    current_.name = jsonText(jsonMember(node, "name"));
    FOURDVT_TRY(checkName());
    FOURDVT_TRY(parameters(node));
    const Json& members = jsonMember(node, "members");
    if (!members.is_array() || members.size() < kMinMembers || members.size() > kMaxMembers)
      return error("needs \"members\", a list of 2 to 4 sequences");
    for (const Json& entry : members) FOURDVT_TRY(member(entry));
    classes_.push_back(std::move(current_));
    return {};
  }

  Status checkName() const {
    const std::string& name = current_.name;
    if (name.empty() || name.find_first_of("/\\") != std::string::npos || name[0] == '.')
      return error("needs a \"name\" that could name a file");
    if (find(name)) return error("has the name of a sequence; rename the class");
    for (const CaptureClass& other : classes_) {
      if (other.name == name) return error("is listed twice; rename one of them");
    }
    return {};
  }

  Status parameters(const Json& node) {
    const Json& given = jsonMember(node, "parameter");
    const Json list = given.is_array() ? given : Json::array({given});
    std::vector<std::string>& names = current_.parameters;
    for (const Json& name : list) names.push_back(jsonText(name));
    const bool named = std::none_of(names.begin(), names.end(), [](const std::string& n) { return n.empty(); });
    if (names.empty() || names.size() > kMaxParameters || !named || (names.size() == 2 && names[0] == names[1]))
      return error("needs \"parameter\", a name such as \"speed_mps\" or a list of two different ones");
    return {};
  }

  Status member(const Json& node) {
    CaptureClass::MemberOf out;
    out.sequence = jsonText(node.is_object() ? jsonMember(node, "sequence") : node);
    const CaptureSequence* sequence = find(out.sequence);
    if (!sequence) return error("has a member \"" + out.sequence + "\" that is no sequence; choose among: " + known());
    for (const CaptureClass::MemberOf& other : current_.members) {
      if (other.sequence == out.sequence) return error("lists \"" + out.sequence + "\" twice; remove one of them");
      if (find(other.sequence)->loop != sequence->loop) {
        return error("mixes a loop with a motion that ends (\"" + other.sequence + "\", \"" + out.sequence +
                     "\"); keep to one kind");
      }
    }
    const Json& value = jsonMember(node, "value");
    if (!value.is_null() &&
        (!readNumbers(value, out.parameter) || out.parameter.size() != current_.parameters.size())) {
      return error("needs one number for each of its parameters (" + std::to_string(current_.parameters.size()) +
                   ") as \"value\" of \"" + out.sequence + "\", or none");
    }
    current_.members.push_back(std::move(out));
    return {};
  }

  std::string known() const {
    return joined(sequences_, ", ", [](const DeclaredSequence& declared) { return declared.sequence.name; });
  }

  const std::vector<DeclaredSequence>& sequences_;
  const std::string& file_;
  CaptureClass current_;
  std::vector<CaptureClass> classes_;
};

}  // namespace

Result<std::vector<CaptureClass>> parseClasses(const Json& list, const std::vector<DeclaredSequence>& sequences,
                                               const std::string& file) {
  return ClassParser(sequences, file).parse(list);
}

nlohmann::ordered_json classesJson(const std::vector<CaptureClass>& classes) {
  const auto oneOrList = [](const auto& list) {
    return list.size() == 1 ? nlohmann::ordered_json(list[0]) : nlohmann::ordered_json(list);
  };
  auto out = nlohmann::ordered_json::array();
  for (const CaptureClass& c : classes) {
    out.push_back(
        {{"name", c.name}, {"parameter", oneOrList(c.parameters)}, {"members", nlohmann::ordered_json::array()}});
    for (const CaptureClass::MemberOf& m : c.members) {
      nlohmann::ordered_json member = m.sequence;
      if (!m.parameter.empty()) member = {{"sequence", m.sequence}, {"value", oneOrList(m.parameter)}};
      out.back()["members"].push_back(std::move(member));
    }
  }
  return out;
}

}  // namespace fourdvt::capture
