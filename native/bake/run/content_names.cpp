// SPDX-License-Identifier: Apache-2.0
#include "bake/run/content_names.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "base/hash.h"
#include "platform/files.h"

namespace fourdvt::bake {
namespace {

constexpr uint64_t kPartBytes = 1 << 20;

Result<uint64_t> hashOf(const std::string& path) {
  const uint64_t bytes = platform::fileBytes(path);
  uint64_t hash = kFnv1aStart;
  for (uint64_t at = 0; at < bytes; at += kPartBytes) {
    FOURDVT_ASSIGN(const auto part, platform::readFileRange(path, at, std::min(kPartBytes, bytes - at)));
    hash = fnv1a(part, hash);
  }
  return hash;
}

}  // namespace

std::string contentName(const std::string& name, uint64_t hash) {
  char digits[10];
  std::snprintf(digits, sizeof digits, ".%08x", static_cast<unsigned>(hash >> 32));
  return std::string(name).insert(name.rfind('.'), digits);
}

Result<std::string> writeNamed(const std::string& folder, const std::string& name, std::span<const uint8_t> bytes) {
  std::string named = contentName(name, fnv1a(bytes));
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/" + named, bytes));
  return named;
}

Result<std::string> nameByContent(const std::string& folder, const std::string& name) {
  FOURDVT_ASSIGN(const uint64_t hash, hashOf(folder + "/" + name));
  std::string named = contentName(name, hash);
  std::error_code error;
  std::filesystem::rename(folder + "/" + name, folder + "/" + named, error);
  if (error) return Error{ErrorId::WriteFailed, folder + "/" + named + ": cannot write: " + error.message()};
  return named;
}

}  // namespace fourdvt::bake
