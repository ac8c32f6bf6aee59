// SPDX-License-Identifier: Apache-2.0
// Names of files that hold a hash of their content, so that no two contents have one name (package/FORMAT.md). Only for
// files that are found through the manifest.
#pragma once

#include <span>
#include <string>

#include "base/result.h"

namespace fourdvt::bake {

// "walk.bin" → "walk.3f9a1c20.bin": the first 8 of the hash's 16 hexadecimal digits.
std::string contentName(const std::string& name, uint64_t hash);
// Writes the file under its contentName, which it returns. Errors: WriteFailed.
Result<std::string> writeNamed(const std::string& folder, const std::string& name, std::span<const uint8_t> bytes);
// Gives a finished file its contentName, which it returns. Holds one part of the file in memory at a time. Errors:
// FileUnreadable, WriteFailed.
Result<std::string> nameByContent(const std::string& folder, const std::string& name);

}  // namespace fourdvt::bake
