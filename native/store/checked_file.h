// SPDX-License-Identifier: Apache-2.0
// Files of finished work: a payload, followed by its hash, so that a damaged or half-written one is found.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::store {

// Writes atomically. Errors: WriteFailed.
Status saveChecked(const std::string& path, std::span<const uint8_t> payload);
// Returns the payload. Errors: FileUnreadable; Internal if damaged.
Result<std::vector<uint8_t>> loadChecked(const std::string& path);
Error damagedFile(const std::string& path);

}  // namespace fourdvt::store
