// SPDX-License-Identifier: Apache-2.0
// Decodes the transfer function of sRGB (IEC 61966-2-1).
#pragma once

#include <cmath>

namespace fourdvt {

// Linear light of an encoded value; both lie in 0…1.
template <class T>
T linearFromSrgb(T v) {
  return v <= T(0.04045) ? v / T(12.92) : std::pow((v + T(0.055)) / T(1.055), T(2.4));
}

}  // namespace fourdvt
