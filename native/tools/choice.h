// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <utility>

#include "tools/args.h"

namespace fourdvt::tools {

// The value of option `name`, which must be one of `known`; `otherwise` if it is not given or is none of them.
template <class T>
T choice(Args& args, const char* name, T otherwise, std::initializer_list<std::pair<const char*, T>> known) {
  if (!args.has(name)) return otherwise;
  std::string list;
  for (const auto& [text, value] : known) {
    if (args.text(name) == text) return value;
    list += (list.empty() ? "" : ", ") + std::string(text);
  }
  args.complain(std::string(name) + " must be one of " + list + ", not \"" + args.text(name) + "\"");
  return otherwise;
}

}  // namespace fourdvt::tools
