// SPDX-License-Identifier: Apache-2.0
#include "package/live_frame.h"

#include "base/bytes.h"

namespace fourdvt::package {
namespace {

constexpr uint32_t kLiveMagic = 0x4c564434;  // "4DVL"
constexpr uint16_t kLiveVersion = 1, kKeyFlag = 1;

Error invalidFrame(const char* what) {
  return {ErrorId::StreamInvalid, std::string("live stream: ") + what + "; connect again"};
}

}  // namespace

std::vector<uint8_t> writeLiveFrame(const LiveFrame& frame) {
  ByteWriter out;
  out.u32(kLiveMagic);
  out.u16(kLiveVersion);
  out.u16(frame.key ? kKeyFlag : 0);
  out.u32(frame.number);
  out.u64(static_cast<uint64_t>(frame.captured_us));
  out.u32(static_cast<uint32_t>(frame.chunk.size()));
  out.u32(static_cast<uint32_t>(frame.sample.size()));
  out.bytes(frame.chunk);
  out.bytes(frame.sample);
  return out.take();
}

Result<LiveFrame> readLiveFrame(std::span<const uint8_t> bytes) {
  if (bytes.size() > kMaxLiveFrameBytes) return invalidFrame("frame of more than 8 MiB");
  ByteReader in(bytes);
  if (in.u32() != kLiveMagic || !in.ok()) return invalidFrame("not a frame");
  const uint16_t version = in.u16();
  if (in.ok() && version != kLiveVersion)
    return Error{ErrorId::Unsupported, "live stream of a newer version; update the player"};
  const uint16_t flags = in.u16();
  if (flags > kKeyFlag) return invalidFrame("unknown flags");
  LiveFrame frame;
  frame.key = flags == kKeyFlag;
  frame.number = in.u32();
  frame.captured_us = static_cast<int64_t>(in.u64());
  const uint32_t chunk_bytes = in.u32(), sample_bytes = in.u32();
  frame.chunk = in.bytes(chunk_bytes);
  frame.sample = in.bytes(sample_bytes);
  if (!in.ok() || in.remaining() > 0) return invalidFrame("lengths do not add up");
  if (frame.chunk.empty() || frame.sample.empty()) return invalidFrame("frame without surface or picture");
  return frame;
}

}  // namespace fourdvt::package
