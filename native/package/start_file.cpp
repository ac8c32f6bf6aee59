// SPDX-License-Identifier: Apache-2.0
#include "package/start_file.h"

#include <array>

#include "base/bytes.h"

namespace fourdvt::package {
namespace {

constexpr size_t kStartParts = 5;

Error invalidStart(const char* problem) { return {ErrorId::StreamInvalid, std::string("start file: ") + problem}; }

}  // namespace

Result<StartFile> readStartFile(std::span<const uint8_t> bytes) {
  ByteReader in(bytes);
  const bool known = in.u32() == kStartMagic && in.u16() == kStartVersion && in.u16() == 0;
  std::array<uint32_t, kStartParts> sizes;
  for (uint32_t& size : sizes) size = in.u32();
  std::array<std::span<const uint8_t>, kStartParts> parts;
  for (size_t i = 0; i < kStartParts; ++i) parts[i] = in.bytes(sizes[i]);
  if (!known || !in.ok() || in.remaining() > 0) return invalidStart("is of another kind, too short or too long");
  StartFile out;
  FOURDVT_ASSIGN(out.index, readStreamHeader(parts[1]));
  const bool one = out.index.frame_count == 1 && out.index.renditions.size() == 1;
  if (!one || out.index.chunks[0].bytes != parts[2].size() ||
      out.index.renditions[0].samples[0].bytes != parts[3].size())
    return invalidStart("has not one frame of the lengths that its header says");
  out.mesh = parts[0];
  out.header = parts[4];
  out.chunk.assign(parts[2].begin(), parts[2].end());
  out.video.assign(parts[3].begin(), parts[3].end());
  return out;
}

}  // namespace fourdvt::package
