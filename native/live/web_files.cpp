// SPDX-License-Identifier: Apache-2.0
#include "live/web_files.h"

#include <filesystem>
#include <utility>

namespace fourdvt::live {
namespace {

namespace fs = std::filesystem;

constexpr std::pair<const char*, const char*> kTypes[] = {
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".mjs", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".wasm", "application/wasm"},
    {".gltf", "model/gltf+json"},
    {".bin", "application/octet-stream"},
    {".mp4", "video/mp4"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".jpg", "image/jpeg"},
    {".webp", "image/webp"},
    {".ico", "image/x-icon"},
    {".txt", "text/plain; charset=utf-8"},
};

const char* typeOf(const fs::path& file) {
  const std::string extension = file.extension().string();
  for (const auto& type : kTypes)
    if (extension == type.first) return type.second;
  return "application/octet-stream";
}

// True for a path without empty parts and without parts that begin with a dot.
bool isPlain(const std::string& path) {
  return !path.empty() && path[0] == '/' && path.find("//") == std::string::npos &&
         path.find("/.") == std::string::npos && path.find('\\') == std::string::npos &&
         path.find('\0') == std::string::npos;
}

bool isInside(const fs::path& file, const fs::path& root) {
  const fs::path relative = file.lexically_relative(root);
  return !relative.empty() && *relative.begin() != "..";
}

std::string percentEncoded(const std::string& path) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  std::string out;
  for (const char c : path) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) || std::string("/-_.~").find(c) < 5;
    if (is_plain)
      out += c;
    else
      out += {'%', kDigits[static_cast<unsigned char>(c) >> 4], kDigits[c & 15]};
  }
  return out;
}

HttpAnswer missing() {
  HttpAnswer answer;
  answer.status = 404;
  answer.body = "there is no such file";
  return answer;
}

}  // namespace

HttpAnswer webFile(const std::string& folder, const std::string& path) {
  if (folder.empty() || !isPlain(path)) return missing();
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return missing();
  fs::path file = fs::canonical(root / path.substr(1), error);
  if (error || !isInside(file, root)) return missing();
  HttpAnswer answer;
  if (fs::is_directory(file, error)) {
    if (path.back() != '/') {
      answer.status = 302;
      answer.location = percentEncoded(path) + "/";
      return answer;
    }
    file = fs::canonical(file / "index.html", error);
    if (error || !isInside(file, root)) return missing();
  }
  if (!fs::is_regular_file(file, error)) return missing();
  answer.file = file.string();
  answer.type = typeOf(file);
  return answer;
}

}  // namespace fourdvt::live
