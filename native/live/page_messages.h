// SPDX-License-Identifier: Apache-2.0
// Messages from pages: viewers send {"type":"ping","t":NUMBER}; the console also {"tolerance_px":X}, {"crf":N} or both.
// Anything else is rejected.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "base/result.h"

namespace fourdvt::live {

constexpr size_t kMaxPageMessageBytes = 1024;

struct PageMessage {
  std::optional<double> ping_t;        // time stamp of a ping
  std::optional<double> tolerance_px;  // 0 (automatic) … 64
  std::optional<int> crf;              // 0…51
};

// Errors: StreamInvalid.
Result<PageMessage> readPageMessage(std::span<const uint8_t> bytes, bool is_console);
std::string pongJson(double ping_t, int64_t server_us);

}  // namespace fourdvt::live
