// SPDX-License-Identifier: Apache-2.0
// Writes encoded GOPs as a faststart .mp4, and reads the sample table back from the finished file.
#pragma once

#include <functional>
#include <string>

#include "encode/encoder.h"
#include "package/stream_file.h"

namespace fourdvt::encode {

// Loads GOP g of the sequence; called in order, with one GOP in memory at a time.
using LoadGop = std::function<Result<EncodedGop>(uint32_t gop)>;

// Errors: WriteFailed, Internal (parameter sets differ between GOPs), and those of `load`.
Status writeMp4(const std::string& path, const EncodeSettings& settings, uint32_t gop_count, const LoadGop& load);

struct Mp4Samples {
  package::SampleTable table;  // decoder_description: avcC for H.264, empty for VP9 and AV1 (not needed by WebCodecs)
  std::string codec;           // RFC 6381, BT.709 limited range
  uint64_t file_bytes = 0;
};

// Demuxes the file; checks that the bytes at every sample's offset are the sample, that frames are 0..n-1 once, and
// that a chunk's samples are contiguous. `gop_first_frames` ascending, starts with 0. Errors: Internal.
Result<Mp4Samples> readMp4Samples(const std::string& path, double fps, const std::vector<uint32_t>& gop_first_frames,
                                  uint32_t frame_count);

}  // namespace fourdvt::encode
