// SPDX-License-Identifier: Apache-2.0
// Constants of the motion graph's file; its layout is described in graph_encode.cpp and FORMAT.md.
#pragma once

#include <cstdint>

namespace fourdvt::motion {

constexpr uint32_t kGraphMagic = 0x47564434;  // "4DVG"
constexpr uint16_t kGraphVersion = 2;
constexpr uint32_t kGraphEntryBytes = 24;

}  // namespace fourdvt::motion
