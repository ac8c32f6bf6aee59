// SPDX-License-Identifier: Apache-2.0
#include "live/net/http_text.h"

#include <algorithm>
#include <charconv>

namespace fourdvt::live {
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
  if (dash == 0) {  // the last bytes
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
