// SPDX-License-Identifier: Apache-2.0
// Text of HTTP and WebSocket: request targets, byte ranges, addresses of servers. Does NOT touch sockets or files.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"

namespace fourdvt::live {

struct Target {
  std::string path;  // percent-decoded, begins with "/"
  std::map<std::string, std::string> query;
};

// None: not a path, a malformed escape, or an escaped NUL.
std::optional<Target> parseTarget(std::string_view target);

// Bytes of a file that a "Range" header asks for; status 200 (all: no range, several, or a malformed one), 206 or 416.
struct RangeAnswer {
  int status = 200;
  uint64_t first = 0, bytes = 0;
};
RangeAnswer parseRange(std::string_view header, uint64_t file_bytes);

struct Url {
  bool tls = false;
  std::string host, port, target;  // host: without brackets
  std::string authority;           // as the Host header has it
};
// ws://HOST[:PORT][/PATH] or wss://…. Errors: InvalidArgument.
Result<Url> parseUrl(const std::string& url);

// At most `bytes`, cut between characters of UTF-8.
std::string cutText(const std::string& text, size_t bytes);

}  // namespace fourdvt::live
