// SPDX-License-Identifier: Apache-2.0
#include "live/net/http.h"

#include <strings.h>
#include <sys/stat.h>

#include <algorithm>
#include <charconv>

#include "base/text.h"

namespace fourdvt::live {
namespace {

struct OpenedFile {
  FileHandle handle;
  uint64_t bytes = 0;
  std::string tag;
};

OpenedFile openFile(const std::string& path) {
  OpenedFile out;
  out.handle.reset(std::fopen(path.c_str(), "rbe"));
  struct stat about {};
  if (!out.handle || fstat(fileno(out.handle.get()), &about) != 0 || !S_ISREG(about.st_mode)) return {};
  out.bytes = static_cast<uint64_t>(about.st_size);
  out.tag = printed("\"%llx-%llx-%lx\"", static_cast<unsigned long long>(about.st_size),
                    static_cast<unsigned long long>(about.st_mtim.tv_sec), about.st_mtim.tv_nsec);
  return out;
}

void addField(std::string& head, const char* name, const std::string& value) {
  head += name;
  head += ": " + value + "\r\n";
}

std::string beginHead(int status, bool is_last) {
  std::string head = "HTTP/1.1 " + std::to_string(status) + " " + statusText(status) + "\r\n";
  addField(head, "Connection", is_last ? "close" : "keep-alive");
  addField(head, "X-Content-Type-Options", "nosniff");
  return head;
}

OpenedAnswer openText(const HttpAnswer& answer, bool is_last) {
  OpenedAnswer out;
  out.head = beginHead(answer.status, is_last);
  addField(out.head, "Cache-Control", "no-store");
  if (!answer.location.empty()) addField(out.head, "Location", answer.location);
  if (!answer.allow_origin.empty()) {
    addField(out.head, "Access-Control-Allow-Origin", answer.allow_origin);
    addField(out.head, "Vary", "Origin");
  } else {
    addField(out.head, "Cross-Origin-Resource-Policy", "same-origin");  // no embedding by other origins
  }
  if (answer.status == 405) addField(out.head, "Allow", "GET, HEAD");
  addField(out.head, "Content-Type", answer.type);
  addField(out.head, "Content-Length", std::to_string(answer.body.size()));
  out.head += "\r\n";
  out.body = answer.body;
  return out;
}

}  // namespace

std::string statusText(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 206:
      return "Partial Content";
    case 302:
      return "Found";
    case 304:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 416:
      return "Range Not Satisfiable";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    default:
      return "Answer";
  }
}

OpenedAnswer openAnswer(const HttpAnswer& answer, const FileConditions& conditions, bool is_last) {
  if (answer.file.empty()) return openText(answer, is_last);
  OpenedFile file = openFile(answer.file);
  if (!file.handle) {
    HttpAnswer missing;
    missing.status = 404;
    missing.body = "there is no such file";
    return openText(missing, is_last);
  }
  OpenedAnswer out;
  RangeAnswer range = parseRange(conditions.range, file.bytes);
  if (conditions.none_match == file.tag) range = {304, 0, 0};
  if (range.bytes > 0 && fseeko(file.handle.get(), static_cast<off_t>(range.first), SEEK_SET) != 0) range = {416, 0, 0};
  out.head = beginHead(range.status, is_last);
  addField(out.head, "Cache-Control", "no-cache");
  addField(out.head, "ETag", file.tag);
  addField(out.head, "Accept-Ranges", "bytes");
  const std::string all = "/" + std::to_string(file.bytes);
  if (range.status == 206)
    addField(out.head, "Content-Range",
             "bytes " + std::to_string(range.first) + "-" + std::to_string(range.first + range.bytes - 1) + all);
  if (range.status == 416) addField(out.head, "Content-Range", "bytes *" + all);
  addField(out.head, "Content-Type", answer.type);
  if (range.status != 304) addField(out.head, "Content-Length", std::to_string(range.bytes));
  out.head += "\r\n";
  out.file = std::move(file.handle);
  out.file_bytes = range.bytes;
  return out;
}

std::string bearerToken(const std::string& authorization) {
  constexpr const char* kScheme = "Bearer ";
  constexpr size_t kLength = 7;
  if (strncasecmp(authorization.c_str(), kScheme, kLength) != 0) return {};
  return authorization.substr(kLength);
}

namespace {

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<std::string> percentDecoded(std::string_view text, bool plus_is_space) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += plus_is_space && text[i] == '+' ? ' ' : text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const int high = hexDigit(text[i + 1]), low = hexDigit(text[i + 2]);
    if (high < 0 || low < 0 || high + low == 0) return std::nullopt;
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

std::optional<uint64_t> wholeNumber(std::string_view text) {
  uint64_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<Target> parseTarget(std::string_view target) {
  Target out;
  const size_t mark = std::min(target.find('?'), target.size());
  const auto path = percentDecoded(target.substr(0, mark), false);
  if (!path || path->empty() || path->front() != '/') return std::nullopt;
  out.path = *path;
  std::string_view rest = target.substr(std::min(mark + 1, target.size()));
  while (!rest.empty()) {
    const size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view part = rest.substr(0, end);
    const size_t equals = std::min(part.find('='), part.size());
    const auto name = percentDecoded(part.substr(0, equals), true);
    const auto value = percentDecoded(part.substr(std::min(equals + 1, part.size())), true);
    if (!name || !value) return std::nullopt;
    if (!name->empty()) out.query.emplace(*name, *value);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return out;
}

RangeAnswer parseRange(std::string_view header, uint64_t file_bytes) {
  const RangeAnswer all{200, 0, file_bytes}, none{416, 0, 0};
  constexpr std::string_view kUnit = "bytes=";
  if (header.substr(0, kUnit.size()) != kUnit) return all;
  header.remove_prefix(kUnit.size());
  const size_t dash = header.find('-');
  if (dash == std::string_view::npos || header.find(',') != std::string_view::npos) return all;
  const auto first = wholeNumber(header.substr(0, dash)), last = wholeNumber(header.substr(dash + 1));
  if (dash == 0) {  // suffix range: the last bytes
    if (!last) return all;
    if (*last == 0 || file_bytes == 0) return none;
    const uint64_t bytes = std::min(*last, file_bytes);
    return {206, file_bytes - bytes, bytes};
  }
  const bool is_open = dash + 1 == header.size();
  if (!first || (!last && !is_open) || (last && *last < *first)) return all;
  if (*first >= file_bytes) return none;
  const uint64_t end = is_open ? file_bytes - 1 : std::min(*last, file_bytes - 1);
  return {206, *first, end - *first + 1};
}

Result<Url> parseUrl(const std::string& url) {
  const Error wrong{ErrorId::InvalidArgument,
                    "\"" + url + "\" is not an address of a live server; give ws://HOST:PORT or wss://HOST:PORT"};
  Url out;
  std::string_view rest = url;
  if (rest.substr(0, 5) == "ws://") {
    rest.remove_prefix(5);
  } else if (rest.substr(0, 6) == "wss://") {
    rest.remove_prefix(6);
    out.tls = true;
  } else {
    return wrong;
  }
  const bool is_plain = std::all_of(url.begin(), url.end(), [](char c) { return c > 0x20 && c < 0x7f; });
  const size_t slash = std::min(rest.find_first_of("/?#"), rest.size());
  out.authority = rest.substr(0, slash);
  out.target = rest.substr(slash);
  if (out.target.empty() || out.target[0] != '/') out.target.insert(0, "/");
  std::string_view host = out.authority;
  if (!is_plain || host.find('@') != std::string_view::npos || out.target.find('#') != std::string::npos) return wrong;
  const size_t bracket = host.find(']');
  const size_t colon = host.find(':', bracket == std::string_view::npos ? 0 : bracket);
  out.port = out.tls ? "443" : "80";
  if (colon != std::string_view::npos) {
    const auto port = wholeNumber(host.substr(colon + 1));
    if (!port || *port < 1 || *port > 65535) return wrong;
    out.port = std::to_string(*port);
    host = host.substr(0, colon);
  }
  if (bracket != std::string_view::npos) {
    if (host.size() < 3 || host.front() != '[' || host.back() != ']') return wrong;
    host = host.substr(1, host.size() - 2);
  }
  if (host.empty()) return wrong;
  out.host = host;
  return out;
}

std::string cutText(const std::string& text, size_t bytes) {
  if (text.size() <= bytes) return text;
  while (bytes > 0 && (static_cast<uint8_t>(text[bytes]) & 0xc0) == 0x80) --bytes;
  return text.substr(0, bytes);
}

}  // namespace fourdvt::live
