// SPDX-License-Identifier: Apache-2.0
// Shaders of a folder such as shaders/gles, read at opening, with `#include`s expanded. Maps lines in compiler messages
// back to files.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace fourdvt::platform {

class ShaderFolder {
 public:
  // Errors: FileMissing (no shader in the folder).
  static Result<ShaderFolder> open(const std::string& folder);
  // Returns the shader of that name, valid for the lifetime of this object; for a missing file, an #error that names
  // it.
  std::string_view text(std::string_view name);
  // Replaces line numbers of these texts in a compiler's log by "FILE:LINE".
  std::string nameLines(const std::string& log) const;

 private:
  std::string expand(const std::string& name, std::vector<std::string>& seen) const;
  std::string lineOf(const std::string& name, size_t line) const;

  std::string folder_;
  std::vector<std::string> names_;
  std::map<std::string, std::string, std::less<>> files_, texts_;
};

}  // namespace fourdvt::platform
