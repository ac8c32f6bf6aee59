// SPDX-License-Identifier: Apache-2.0
#include "platform/shader_folder.h"

#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>

#include "platform/files.h"

namespace fourdvt::platform {
namespace {

// Lines per file in combined line numbers, as GLSL has no file names: line 12 of the third file is line 300012.
// web/develop/glsl.mjs counts likewise.
constexpr size_t kLinesPerFile = 100'000;

bool isShader(const std::filesystem::path& path) {
  const std::string kind = path.extension().string();
  return kind == ".vert" || kind == ".frag" || kind == ".glsl";
}

}  // namespace

Result<ShaderFolder> ShaderFolder::open(const std::string& folder) {
  ShaderFolder out;
  out.folder_ = folder;
  std::error_code ignored;
  for (std::filesystem::directory_iterator file(folder, ignored), end; file != end; file.increment(ignored)) {
    if (!isShader(file->path())) continue;
    FOURDVT_ASSIGN(const auto bytes, readFile(file->path().string()));
    out.files_[file->path().filename().string()].assign(bytes.begin(), bytes.end());
  }
  if (out.files_.empty())
    return Error{ErrorId::FileMissing, folder + ": has no shaders; name a folder such as shaders/gles"};
  for (const auto& [name, text] : out.files_) out.names_.push_back(name);
  return out;
}

std::string_view ShaderFolder::text(std::string_view name) {
  const auto known = texts_.find(name);
  if (known != texts_.end()) return known->second;
  std::vector<std::string> seen;
  return texts_.emplace(name, expand(std::string(name), seen)).first->second;
}

std::string ShaderFolder::expand(const std::string& name, std::vector<std::string>& seen) const {
  const auto file = files_.find(name);
  if (file == files_.end()) return "#error " + folder_ + " has no " + name + ": add it or correct the include\n";
  static const std::regex kInclude("\\s*#include \"(\\w+\\.glsl)\".*");
  std::string out = lineOf(name, 1), line;
  std::istringstream lines(file->second);
  for (size_t number = 1; std::getline(lines, line); ++number) {
    std::smatch found;
    if (!std::regex_match(line, found, kInclude)) {
      out += line + "\n";
      continue;
    }
    const std::string part = found[1];
    if (std::find(seen.begin(), seen.end(), part) == seen.end()) {
      seen.push_back(part);
      out += expand(part, seen);
    }
    out += lineOf(name, number + 1);
  }
  return out;
}

std::string ShaderFolder::lineOf(const std::string& name, size_t line) const {
  const size_t file = static_cast<size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
  return "#line " + std::to_string(kLinesPerFile * (file + 1) + line) + "\n";
}

std::string ShaderFolder::nameLines(const std::string& log) const {
  static const std::regex kNumber("(\\b0[:(])?\\b(\\d{6,8})\\b");
  std::string out;
  auto rest = log.cbegin();
  for (std::sregex_iterator found(log.begin(), log.end(), kNumber), end; found != end; ++found) {
    const size_t number = std::stoul((*found)[2]), file = number / kLinesPerFile;
    if (file < 1 || file > names_.size()) continue;
    out.append(rest, (*found)[0].first);
    out += names_[file - 1] + ":" + std::to_string(number % kLinesPerFile);
    rest = (*found)[0].second;
  }
  return out.append(rest, log.cend());
}

}  // namespace fourdvt::platform
