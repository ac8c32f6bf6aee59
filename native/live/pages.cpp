// SPDX-License-Identifier: Apache-2.0
#include "live/pages.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace fourdvt::live {
namespace {

namespace fs = std::filesystem;

Error refused(const char* what) {
  return {ErrorId::StreamInvalid, std::string("live page: ") + what + "; use the page of the server's version"};
}

// Keys of a message, with a count of those that were read.
class Fields {
 public:
  explicit Fields(const nlohmann::json& json) : json_(json) {}
  std::optional<double> number(const char* name, double low, double high) {
    const auto at = json_.find(name);
    if (at == json_.end()) return std::nullopt;
    ++read_;
    const double value = at->is_number() ? at->get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!(value >= low && value <= high)) is_wrong_ = true;
    return value;
  }
  bool isPing() {
    const auto at = json_.find("type");
    if (at == json_.end()) return false;
    ++read_;
    if (*at != "ping") is_wrong_ = true;
    return true;
  }
  bool areAllRight() const { return !is_wrong_ && read_ == json_.size() && read_ > 0; }

 private:
  const nlohmann::json& json_;
  size_t read_ = 0;
  bool is_wrong_ = false;
};

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

Result<PageMessage> readPageMessage(std::span<const uint8_t> bytes, bool is_console) {
  if (bytes.size() > kMaxPageMessageBytes) return refused("message too long");
  const nlohmann::json json = nlohmann::json::parse(bytes.begin(), bytes.end(), nullptr, false);
  if (!json.is_object()) return refused("message is no JSON object");
  PageMessage message;
  Fields fields(json);
  if (fields.isPing()) {
    message.ping_t = fields.number("t", -1e300, 1e300);
    if (!message.ping_t) return refused("ping without a number");
  } else if (is_console) {
    message.tolerance_px = fields.number("tolerance_px", 0, 64);
    const auto crf = fields.number("crf", 0, 51);
    if (crf && *crf != std::floor(*crf)) return refused("crf is no whole number");
    if (crf && fields.areAllRight()) message.crf = static_cast<int>(*crf);
  }
  if (!fields.areAllRight()) return refused("unknown message, or a number out of range");
  return message;
}

std::string pongJson(double ping_t, int64_t server_us) {
  return nlohmann::json{{"type", "pong"}, {"t", ping_t}, {"now", server_us}}.dump();
}

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
