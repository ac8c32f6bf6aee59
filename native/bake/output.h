// SPDX-License-Identifier: Apache-2.0
// Files that the bake writes: whole, fsynced and renamed, or not at all. Does NOT know what is in them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::bake {

Status writeFile(const std::string& path, std::span<const uint8_t> bytes);  // WriteFailed
Status writeFile(const std::string& path, const std::string& text);
Result<std::vector<uint8_t>> readFile(const std::string& path);  // FileMissing, FileUnreadable
uint64_t fileBytes(const std::string& path);                     // 0 if there is none

// Creates the folder and its parents. Errors: WriteFailed.
Status makeFolder(const std::string& path);
void removeFolder(const std::string& path);
void removeIfEmpty(const std::string& path);
// `from` takes the place of `to`; an earlier `to` becomes `previous`. On failure `to` is as before. One file system.
// Errors: WriteFailed.
Status replaceFolder(const std::string& from, const std::string& to, const std::string& previous);

}  // namespace fourdvt::bake
