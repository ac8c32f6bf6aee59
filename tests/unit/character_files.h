// SPDX-License-Identifier: Apache-2.0
// Finds files of a baked character, and of its work folder, by their names without hashes.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

namespace fourdvt {

// Path of a file in `folder` by its name without a hash: "walk.bin" finds walk.3f9a1c20.bin, if the manifest names it.
// Returns other names as paths in the folder.
inline std::string fileNamed(const std::string& folder, const std::string& name) {
  std::ifstream in(folder + "/character.gltf", std::ios::binary);
  const std::string gltf{std::istreambuf_iterator<char>(in), {}};
  const auto literal = [](const std::string& text) { return std::regex_replace(text, std::regex("\\."), "\\."); };
  const size_t dot = name.rfind('.');
  const std::regex uri("\"uri\": \"(" + literal(name.substr(0, dot)) + "(\\.[0-9a-f]{8})?" + literal(name.substr(dot)) +
                       ")\"");
  std::smatch found;
  return folder + "/" + (std::regex_search(gltf, found, uri) ? found[1].str() : name);
}

// Path of a file at any depth of a work folder; empty if there is none.
inline std::string workFile(const std::string& folder, const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code gone;  // a running bake removes folders
  for (fs::recursive_directory_iterator file(folder, gone), end; !gone && file != end; file.increment(gone))
    if (file->path().filename() == name) return file->path().string();
  return {};
}

}  // namespace fourdvt
