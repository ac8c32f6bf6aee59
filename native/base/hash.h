// SPDX-License-Identifier: Apache-2.0
// FNV-1a, 64 bit: keys and checksums of files written by this program, and content hashes of a character
// (package/FORMAT.md). Not cryptographic: forgery goes undetected.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace fourdvt {

constexpr uint64_t kFnv1aStart = 14695981039346656037ull;

// `hash`: kFnv1aStart, or the hash of the preceding bytes.
inline uint64_t fnv1a(std::span<const uint8_t> bytes, uint64_t hash = kFnv1aStart) {
  for (const uint8_t byte : bytes) hash = (hash ^ byte) * 1099511628211ull;
  return hash;
}

inline uint64_t fnv1a(std::string_view text, uint64_t hash = kFnv1aStart) {
  return fnv1a(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()), hash);
}

}  // namespace fourdvt
