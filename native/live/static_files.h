// SPDX-License-Identifier: Apache-2.0
// Which file of a folder a path of HTTP means. Does NOT open it.
#pragma once

#include <optional>
#include <string>

namespace fourdvt::live {

struct StaticFile {
  std::string path, type;
};

// path: percent-decoded, begins with "/"; a folder means the page that is its index. None:
// there is no such file, or it lies outside of the folder, or a part of its
// name begins with a dot.
std::optional<StaticFile> staticFile(const std::string& folder, const std::string& path);

}  // namespace fourdvt::live
