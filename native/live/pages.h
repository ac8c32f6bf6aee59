// SPDX-License-Identifier: Apache-2.0
// Pages that a live server answers: their messages, and their files by HTTP path.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "base/result.h"
#include "live/net/websocket.h"

namespace fourdvt::live {

constexpr size_t kMaxPageMessageBytes = 1024;

// Message of a page: viewers send {"type":"ping","t":NUMBER}; the console also {"tolerance_px":X}, {"crf":N} or both.
// Anything else is rejected.
struct PageMessage {
  std::optional<double> ping_t;        // time stamp of a ping
  std::optional<double> tolerance_px;  // 0 (automatic) … 64
  std::optional<int> crf;              // 0…51
};

// Errors: StreamInvalid.
Result<PageMessage> readPageMessage(std::span<const uint8_t> bytes, bool is_console);
std::string pongJson(double ping_t, int64_t server_us);

// Finds a file of a folder by HTTP path. Files outside the folder are not found, even through links, nor are names that
// begin with a dot. Returns the file, the index of a folder, a redirection to a folder's address with a trailing "/",
// or 404. path: as HttpRequest::path. folder: empty: 404.
HttpAnswer webFile(const std::string& folder, const std::string& path);

}  // namespace fourdvt::live
