// SPDX-License-Identifier: Apache-2.0
// Checks the fixed front of Draco data before the library sees it, so that corrupt counts cannot make it allocate.
// Does NOT decode. Internal to package/.
#pragma once

#include <cstdint>
#include <span>

namespace fourdvt::package {

// True for a sequential point cloud of exactly `point_count` points with `attribute_count` generic 32-bit integer
// attributes of `components` each.
bool looksLikePointCloud(std::span<const uint8_t> bytes, uint32_t point_count, uint32_t attribute_count,
                         int components);
// True for an edgebreaker mesh whose counts are within limits that the bytes can plausibly hold.
bool looksLikeMesh(std::span<const uint8_t> bytes);

}  // namespace fourdvt::package
