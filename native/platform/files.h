// SPDX-License-Identifier: Apache-2.0
// Whole files and byte ranges; atomic writes (temporary sibling + fsync + rename).
#pragma once

#include <cstdint>
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

}  // namespace fourdvt::platform
