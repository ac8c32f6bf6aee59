// SPDX-License-Identifier: Apache-2.0
// Counter-based random numbers: a value depends on the seed and the key only.
#pragma once

#include <cmath>
#include <cstdint>

namespace fourdvt::studio {

inline uint64_t randomBits(uint64_t seed, uint64_t key) {  // splitmix64
  uint64_t z = seed * 0x9e3779b97f4a7c15ull + key * 0xd1342543de82ef95ull + 0x632be59bd9b4e019ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

// Approximately normal with mean 0 and deviation 1: a scaled sum of eight uniform bytes, |value| < 5.
inline double randomNormal(uint64_t seed, uint64_t key) {
  uint64_t bits = randomBits(seed, key);
  int sum = 0;
  for (int i = 0; i < 8; ++i, bits >>= 8) sum += static_cast<int>(bits & 0xff);
  constexpr double kDeviation = 209.02;  // sqrt(8 * (256² - 1) / 12)
  return (sum - 8 * 127.5) / kDeviation;
}

}  // namespace fourdvt::studio
