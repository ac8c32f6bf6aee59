// SPDX-License-Identifier: Apache-2.0
// Checks the fixed front of Draco data before the library sees it, so that corrupt counts cannot make it allocate.
// Does NOT decode. Internal to package/.
#pragma once

#include <cstdint>
#include <span>

namespace fourdvt::package {

// True for an edgebreaker mesh of at most `max_faces` whose counts the bytes can plausibly hold.
bool looksLikeMesh(std::span<const uint8_t> bytes, uint32_t max_faces);

}  // namespace fourdvt::package
