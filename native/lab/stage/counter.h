// SPDX-License-Identifier: Apache-2.0
// A picture's number, painted on the performer: the 16 cells of package/barcode.h as a square of four by four, row by
// row, black and white. Tells which picture one sees after keying and coding. Does NOT write files.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "base/image.h"

namespace fourdvt::stage {

constexpr int kCounterColumns = 4, kCounterRows = 4;

// The corner of a counter, at even pixels, that lies within the matte (1 channel, ≥ 128: performer) with a cell to
// spare on all sides, as near as may be to the matte's centroid. None: the performer is too small.
std::optional<glm::ivec2> counterPlace(const Image& matte, int cell_px);
void drawCounter(Image& rgb, const glm::ivec2& corner, int cell_px, uint32_t number);
// The number modulo 4096; none where the cells do not agree with their check bits.
std::optional<uint32_t> readCounter(const Image& rgb, const glm::ivec2& corner, int cell_px);

}  // namespace fourdvt::stage
