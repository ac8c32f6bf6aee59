// SPDX-License-Identifier: Apache-2.0
// In-memory coding of pictures and videos, for size and quality.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/image.h"
#include "encode/encoder.h"
#include "encode/tile.h"

namespace fourdvt::study {

// Encodes RGB(A) as RGB in a PNG of zlib level 6 with adaptive filters. Errors: Internal.
Result<std::vector<uint8_t>> encodePng(const Image& image);
using PictureCoder = std::function<Result<std::vector<uint8_t>>(const Image&)>;
// Sum of the coded pictures' bytes; codes on all cores.
Result<uint64_t> codedBytes(const std::vector<Image>& pictures, const PictureCoder& code);

// Converts RGB(A) with even sides to 4:2:0.
void fillI420(const Image& image, encode::I420Picture& out);

uint64_t gopBytes(const encode::EncodedGop& gop);
// Pictures in presentation order; `frame` counts from the GOP's first. Returns their number. Errors: VideoInvalid and
// those of `on_picture`.
Result<size_t> decodeGop(encode::Codec codec, const encode::EncodedGop& gop,
                         const std::function<Status(uint32_t frame, const I420View&)>& on_picture);

// Sum of squared differences over RGB of the pixels inside, and its PSNR.
struct SquaredError {
  double squares = 0;
  uint64_t samples = 0;
  // Requires both pictures of one size with 3 or 4 channels; `inside`: width × height, non-zero: counts.
  void add(const Image& a, const Image& b, const std::vector<uint8_t>& inside);
  void add(const SquaredError& other) { squares += other.squares, samples += other.samples; }
  double psnr_db() const;  // infinity for equal pictures, NaN without pixels
};

}  // namespace fourdvt::study
