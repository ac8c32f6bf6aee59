// SPDX-License-Identifier: Apache-2.0
// An answer of HTTP as bytes: its head, and a body or an open file. Does NOT send.
#pragma once

#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "live/net/websocket.h"

namespace fourdvt::live {
struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using FileHandle = std::unique_ptr<std::FILE, FileCloser>;

struct FileConditions {
  std::string range, none_match;  // the headers "Range" and "If-None-Match"
};

struct OpenedAnswer {
  std::string head, body;  // the head ends with an empty line
  FileHandle file;         // instead of `body`, at the first byte to send
  uint64_t file_bytes = 0;
};

// A file that cannot be opened becomes 404. is_last: the connection is closed after it.
OpenedAnswer openAnswer(const HttpAnswer& answer, const FileConditions& conditions, bool is_last);
std::string statusText(int status);
std::string bearerToken(const std::string& authorization);  // empty: none

// Text of HTTP and WebSocket: request targets, byte ranges, addresses of servers. Does NOT touch sockets or files.

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
