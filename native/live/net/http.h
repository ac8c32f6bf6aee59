// SPDX-License-Identifier: Apache-2.0
// HTTP answers as bytes, and text of HTTP and WebSocket: request targets, byte ranges, server addresses. Performs no
// network I/O.
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
  std::string range, none_match;  // request headers "Range" and "If-None-Match"
};

struct OpenedAnswer {
  std::string head, body;  // the head ends with an empty line
  FileHandle file;         // replaces `body`; positioned at the first byte to send
  uint64_t file_bytes = 0;
};

// Opens the answer's file; 404 if that fails. is_last: the connection closes after this answer.
OpenedAnswer openAnswer(const HttpAnswer& answer, const FileConditions& conditions, bool is_last);
std::string statusText(int status);
std::string bearerToken(const std::string& authorization);  // empty: none

struct Target {
  std::string path;  // percent-decoded, begins with "/"
  std::map<std::string, std::string> query;
};

// Parses a request target. None: not a path, a malformed escape, or an escaped NUL.
std::optional<Target> parseTarget(std::string_view target);

// Byte range requested by a "Range" header; status 200 (all: no range, several, or a malformed one), 206 or 416.
struct RangeAnswer {
  int status = 200;
  uint64_t first = 0, bytes = 0;
};
RangeAnswer parseRange(std::string_view header, uint64_t file_bytes);

struct Url {
  bool tls = false;
  std::string host, port, target;  // host: without brackets
  std::string authority;           // value of the Host header
};
// Parses ws://HOST[:PORT][/PATH] or wss://…. Errors: InvalidArgument.
Result<Url> parseUrl(const std::string& url);

// Truncates to at most `bytes` at a UTF-8 character boundary.
std::string cutText(const std::string& text, size_t bytes);

}  // namespace fourdvt::live
