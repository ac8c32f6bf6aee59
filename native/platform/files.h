// SPDX-License-Identifier: Apache-2.0
// Whole files and byte ranges; atomic writes (temporary sibling + fsync + rename). Output folders of long commands:
// creation with parents, removal, atomic replacement of an older one.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/flat_json.h"
#include "base/image.h"
#include "base/result.h"

namespace fourdvt::platform {

Result<std::vector<uint8_t>> readFile(const std::string& path);
Result<std::string> readText(const std::string& path);
Result<std::vector<uint8_t>> readFileRange(const std::string& path, uint64_t offset, uint64_t bytes);
Status writeFileAtomic(const std::string& path, std::span<const uint8_t> bytes);  // WriteFailed
Status writeFileAtomic(const std::string& path, const std::string& text);
uint64_t fileBytes(const std::string& path);             // 0 if it is missing
Result<FlatJson> readJsonFlat(const std::string& path);  // FileMissing, ManifestInvalid
// PNG/JPEG/WebP through OpenCV; 3- or 4-channel RGB(A).
Result<Image> readImage(const std::string& path);
// `extension`: ".jpg", ".webp" or another supported by an OpenCV encoder. Errors: Internal.
Result<std::vector<uint8_t>> encodeImage(const Image& image, const std::string& extension, int quality);
Status writeImage(const std::string& path, const Image& image, int quality = 90);

// Creates the folder and its parents; leaves an existing one unchanged. Errors: WriteFailed.
Status makeFolder(const std::string& path);
void removeFolder(const std::string& path);
// Variant that deletes the file `last` in it after all else, so that a partly removed folder still has it.
void removeFolder(const std::string& path, const std::string& last);
// Removes the folder's entries whose names satisfy `chosen`.
void removeEntries(const std::string& folder, const std::function<bool(const std::string& name)>& chosen);
void removeIfEmpty(const std::string& path);
// Renames `from` to `to`; an earlier `to` becomes `previous`. On failure `to` is unchanged. All three lie on one file
// system. Errors: WriteFailed.
Status replaceFolder(const std::string& from, const std::string& to, const std::string& previous);

}  // namespace fourdvt::platform
