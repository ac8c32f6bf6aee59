// SPDX-License-Identifier: Apache-2.0
// Frame index in the picture: 16 cells = 12-bit Gray code of (frame mod 4096) + 4-bit CRC (x^4+x+1 over the 12 Gray
// bits), most significant bit first, white (luma 235) = 1; written twice side by side. Identifies a decoded picture's
// frame after any reordering in the decoder.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/image.h"
#include "package/character.h"

namespace fourdvt::package {

constexpr int kBarcodeCells = 16;
uint16_t barcodeBits(uint32_t frame);
// Frame index mod 4096 from 16 bits; nullopt on a CRC mismatch.
std::optional<uint32_t> frameFromBarcode(uint16_t bits);
// Frame index mod 4096 from the lumas of all cells of both copies; the first copy with a matching CRC wins. Lumas above
// `threshold` are white.
std::optional<uint32_t> frameFromCells(const std::array<uint8_t, 2 * kBarcodeCells>& lumas, int threshold);
// Draws cells of limited-range luma into a luma plane.
void drawBarcode(const BarcodeStrip& strip, uint32_t frame, uint8_t* luma, int stride);
// Samples cell centres: first copy, then second.
std::optional<uint32_t> readBarcode(const BarcodeStrip& strip, const I420View& picture);

}  // namespace fourdvt::package
