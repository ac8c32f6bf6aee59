// SPDX-License-Identifier: Apache-2.0
// An answer of HTTP as bytes: its head, and a body or an open file. Does NOT send.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

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

}  // namespace fourdvt::live
