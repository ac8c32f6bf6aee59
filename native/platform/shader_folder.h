// SPDX-License-Identifier: Apache-2.0
// The shaders of a folder such as shaders/gles, as they are when it is opened, with `#include`s expanded. A compiler's
// messages name their lines by file.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace fourdvt::platform {

class ShaderFolder {
 public:
  // Errors: FileMissing where the folder has no shader.
  static Result<ShaderFolder> open(const std::string& folder);
  // Returns the shader of that name, valid as long as this object; where the folder has no such file, an #error that
  // names it.
  std::string_view text(std::string_view name);
  // A compiler's log with "FILE:LINE" in place of the line numbers of these texts.
  std::string nameLines(const std::string& log) const;

 private:
  std::string expand(const std::string& name, std::vector<std::string>& seen) const;
  std::string lineOf(const std::string& name, size_t line) const;

  std::string folder_;
  std::vector<std::string> names_;
  std::map<std::string, std::string, std::less<>> files_, texts_;
};

}  // namespace fourdvt::platform
