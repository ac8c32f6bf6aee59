// SPDX-License-Identifier: Apache-2.0
// A picture's number, painted on the performer: the 16 cells of package/barcode.h as a square of four by four, row by
// row, black and white. Identifies a picture after keying and coding.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "base/image.h"

namespace fourdvt::stage {

constexpr int kCounterColumns = 4, kCounterRows = 4;

// Corner of a counter, at even pixels, inside the matte (1 channel, ≥ 128: performer) with a cell's margin on all
// sides, nearest to the matte's centroid. nullopt: the performer is too small.
std::optional<glm::ivec2> counterPlace(const Image& matte, int cell_px);
void drawCounter(Image& rgb, const glm::ivec2& corner, int cell_px, uint32_t number);
// Number modulo 4096; nullopt if the cells disagree with their check bits.
std::optional<uint32_t> readCounter(const Image& rgb, const glm::ivec2& corner, int cell_px);

}  // namespace fourdvt::stage
