// SPDX-License-Identifier: Apache-2.0
// Messages that pages may send: viewers {"type":"ping","t":NUMBER}; the console that, and {"tolerance_px":X} or {"crf":N} or
// both. Anything else is refused.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "base/result.h"

namespace fourdvt::live {

constexpr size_t kMaxPageMessageBytes = 1024;

struct PageMessage {
  std::optional<double> ping_t;        // a ping
  std::optional<double> tolerance_px;  // 0 (by control) … 64
  std::optional<int> crf;              // 0…51
};

// Errors: StreamInvalid.
Result<PageMessage> readPageMessage(std::span<const uint8_t> bytes, bool is_console);
std::string pongJson(double ping_t, int64_t server_us);

}  // namespace fourdvt::live
