// SPDX-License-Identifier: Apache-2.0
// Plain pictures in memory; row 0 is the top row everywhere in fourdvt.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fourdvt {
// Interleaved 8-bit picture; channels in RGB(A) order; sRGB-encoded values; alpha is straight.
struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<uint8_t> pixels;  // height × width × channels

  Image() = default;
  Image(int w, int h, int c, uint8_t fill = 0)
      : width(w), height(h), channels(c), pixels(static_cast<size_t>(w) * h * c, fill) {}
  bool empty() const { return pixels.empty(); }
  uint8_t* at(int x, int y) { return pixels.data() + (static_cast<size_t>(y) * width + x) * channels; }
  const uint8_t* at(int x, int y) const { return pixels.data() + (static_cast<size_t>(y) * width + x) * channels; }
};

// Display marks stored in a file beside its pixels, in the order of application: stretching, mirroring, rotation.
struct PictureMarks {
  bool mirrored = false;    // left to right
  int quarter_turns = 0;    // clockwise, 0 to 3
  double pixel_aspect = 1;  // stored pixel's width / height
  bool turns() const { return mirrored || quarter_turns != 0; }
  bool swapsSides() const { return quarter_turns % 2 != 0; }
  bool stretches() const { return pixel_aspect != 1; }
};

// Converts RGBA from premultiplied to straight alpha, in the encoded values. Pixels with alpha 0 are unchanged.
inline void unpremultiply(Image& rgba) {
  for (size_t i = 0; i + 3 < rgba.pixels.size(); i += 4) {
    uint8_t* p = &rgba.pixels[i];
    if (p[3] == 0 || p[3] == 255) continue;
    for (int c = 0; c < 3; ++c) p[c] = static_cast<uint8_t>(std::min(255, (p[c] * 255 + p[3] / 2) / p[3]));
  }
}

// Borrowed 4:2:0 picture, BT.709 limited range (the only colour description a character uses).
// width and height are even; chroma planes are (width/2) × (height/2).
struct I420View {
  int width = 0, height = 0;
  const uint8_t* y = nullptr;
  const uint8_t* u = nullptr;
  const uint8_t* v = nullptr;                    // null: interleaved with u (NV12)
  int stride_y = 0, stride_u = 0, stride_v = 0;  // bytes
};

// Inverse transfer function of sRGB (IEC 61966-2-1).

// Linear light of an encoded value; both in 0…1.
template <class T>
T linearFromSrgb(T v) {
  return v <= T(0.04045) ? v / T(12.92) : std::pow((v + T(0.055)) / T(1.055), T(2.4));
}

}  // namespace fourdvt
