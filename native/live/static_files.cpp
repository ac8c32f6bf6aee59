// SPDX-License-Identifier: Apache-2.0
#include "live/static_files.h"

#include <filesystem>
#include <map>

namespace fourdvt::live {
namespace {

namespace fs = std::filesystem;

std::string typeOf(const fs::path& file) {
  static const std::map<std::string, std::string> types{{".html", "text/html; charset=utf-8"},
                                                        {".js", "text/javascript; charset=utf-8"},
                                                        {".mjs", "text/javascript; charset=utf-8"},
                                                        {".css", "text/css; charset=utf-8"},
                                                        {".json", "application/json"},
                                                        {".gltf", "model/gltf+json"},
                                                        {".wasm", "application/wasm"},
                                                        {".mp4", "video/mp4"},
                                                        {".webp", "image/webp"},
                                                        {".png", "image/png"},
                                                        {".jpg", "image/jpeg"},
                                                        {".svg", "image/svg+xml"}};
  const auto found = types.find(file.extension().string());
  return found == types.end() ? "application/octet-stream" : found->second;
}

}  // namespace

std::optional<StaticFile> staticFile(const std::string& folder, const std::string& path) {
  if (folder.empty() || path.empty() || path[0] != '/' || path.find('\\') != std::string::npos) return std::nullopt;
  if (path.find("/.") != std::string::npos) return std::nullopt;
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return std::nullopt;
  fs::path file = fs::canonical(root / path.substr(1), error);
  if (error) return std::nullopt;
  if (fs::is_directory(file, error)) {
    if (path.back() != '/') return std::nullopt;
    file = fs::canonical(file / "index.html", error);
    if (error) return std::nullopt;
  }
  const auto relative = file.lexically_relative(root);
  if (relative.empty() || *relative.begin() == ".." || !fs::is_regular_file(file, error)) return std::nullopt;
  return StaticFile{file.string(), typeOf(file)};
}

}  // namespace fourdvt::live
