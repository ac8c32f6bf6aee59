// SPDX-License-Identifier: Apache-2.0
#include "package/barcode.h"

namespace fourdvt::package {
namespace {

constexpr uint8_t kBlackLuma = 16, kWhiteLuma = 235;

// Remainder of gray * x^4 modulo x^4 + x + 1.
uint16_t crc4(uint16_t gray12) {
  uint16_t remainder = static_cast<uint16_t>(gray12 << 4);
  for (int bit = 15; bit >= 4; --bit) {
    if (remainder & (1u << bit)) remainder = static_cast<uint16_t>(remainder ^ (0x13u << (bit - 4)));
  }
  return remainder & 0xf;
}

// Mean luma of the middle half of a cell.
int cellLuma(const I420View& picture, int x0, int y0, int width, int height) {
  int sum = 0, count = 0;
  for (int y = y0 + height / 4; y < y0 + height - height / 4; ++y) {
    for (int x = x0 + width / 4; x < x0 + width - width / 4; ++x, ++count) {
      sum += picture.y[static_cast<size_t>(y) * picture.stride_y + x];
    }
  }
  return count ? sum / count : 0;
}

}  // namespace

uint16_t barcodeBits(uint32_t frame) {
  const uint32_t index = frame & 0xfffu;
  const uint16_t gray = static_cast<uint16_t>(index ^ (index >> 1));
  return static_cast<uint16_t>((gray << 4) | crc4(gray));
}

std::optional<uint32_t> frameFromBarcode(uint16_t bits) {
  const uint16_t gray = bits >> 4;
  if (crc4(gray) != (bits & 0xf)) return std::nullopt;
  uint32_t index = gray;
  for (int shift = 1; shift < 12; shift <<= 1) index ^= index >> shift;
  return index & 0xfffu;
}

void drawBarcode(const BarcodeStrip& strip, uint32_t frame, uint8_t* luma, int stride) {
  const uint16_t bits = barcodeBits(frame);
  for (int y = strip.rect.y; y < strip.rect.y + strip.rect.height; ++y) {
    for (int x = 0; x < 2 * kBarcodeCells * strip.cell_size; ++x) {
      const int cell = x / strip.cell_size % kBarcodeCells;
      const bool white = (bits >> (kBarcodeCells - 1 - cell)) & 1;
      luma[static_cast<size_t>(y) * stride + strip.rect.x + x] = white ? kWhiteLuma : kBlackLuma;
    }
  }
}

std::optional<uint32_t> readBarcode(const BarcodeStrip& strip, const I420View& picture) {
  const Rect& r = strip.rect;
  if (strip.cell_size < 1 || r.x < 0 || r.y < 0 || r.height < 1 ||
      r.x + 2 * kBarcodeCells * strip.cell_size > picture.width || r.y + r.height > picture.height) {
    return std::nullopt;
  }
  std::array<uint8_t, 2 * kBarcodeCells> lumas;
  for (int cell = 0; cell < 2 * kBarcodeCells; ++cell)
    lumas[static_cast<size_t>(cell)] =
        static_cast<uint8_t>(cellLuma(picture, r.x + cell * strip.cell_size, r.y, strip.cell_size, r.height));
  return frameFromCells(lumas, (kBlackLuma + kWhiteLuma) / 2);
}

std::optional<uint32_t> frameFromCells(const std::array<uint8_t, 2 * kBarcodeCells>& lumas, int threshold) {
  for (size_t copy = 0; copy < 2; ++copy) {
    uint16_t bits = 0;
    for (size_t cell = 0; cell < kBarcodeCells; ++cell)
      bits = static_cast<uint16_t>((bits << 1) | (lumas[copy * kBarcodeCells + cell] > threshold ? 1 : 0));
    if (auto frame = frameFromBarcode(bits)) return frame;
  }
  return std::nullopt;
}

}  // namespace fourdvt::package
