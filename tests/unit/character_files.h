// SPDX-License-Identifier: Apache-2.0
// Files of a baked character by their names without the hash.
#pragma once

#include <fstream>
#include <iterator>
#include <regex>
#include <string>

namespace fourdvt {

// Path of the file that the manifest in `folder` names, with or without a hash: "walk.bin" finds walk.3f9a1c20.bin. Any
// other name: the path of that file.
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

}  // namespace fourdvt
