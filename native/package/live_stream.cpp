// SPDX-License-Identifier: Apache-2.0
#include "package/live_stream.h"

#include "base/bytes.h"
#include "package/field_reader.h"

namespace fourdvt::package {

namespace {

constexpr uint32_t kLiveMagic = 0x4c564434;  // "4DVL"
constexpr uint16_t kLiveVersion = 1, kKeyFlag = 1;

Error invalidFrame(const char* what) {
  return {ErrorId::StreamInvalid, std::string("live stream: ") + what + "; connect again"};
}

Error invalidLive(const std::string& problem) {
  return {ErrorId::ManifestInvalid, "live stream: " + problem + "; update its server, or connect to another"};
}

void readStream(FieldReader& in, const std::string& at, LiveCharacter& live) {
  live.session = in.hash(at, "/session");
  Sequence& s = live.character.sequences.emplace_back();
  s.name = "live";
  s.frame_count = 1;
  s.fps = in.number(at, "/fps", 0.1, 1000);
  readLayout(in, at, s);
  readPicture(in, at, 0, s.renditions.emplace_back());
  s.renditions[0].video_uri = "live stream";  // name in messages
  StreamIndex& index = live.index;
  index.frame_count = 1;
  index.vertex_count = live.character.vertex_count;
  index.face_count = live.character.face_count;
  index.chunks = {{0, 1, 0, 0}};
  index.position_origin = glm::vec3(in.vec3(at, "/origin"));
  index.position_step_m = float(in.number(at, "/step", 1e-6, 1));
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

Result<LiveCharacter> readLiveManifest(const FlatJson& manifest) {
  const std::string at = std::string("/extensions/") + kExtensionName;
  if (manifest.string("/asset/version").value_or("") != "2.0" || !manifest.has(at + "/live"))
    return invalidLive("its first message is no manifest of one");
  FieldReader in(manifest);
  LiveCharacter live;
  live.character.version = int(in.integer(at, "/version", kLiveFormatVersion, 1 << 20));
  if (in.ok() && live.character.version > kLiveFormatVersion)
    return Error{ErrorId::Unsupported, "live stream: version " + std::to_string(live.character.version) +
                                           " is newer than this player; update the player"};
  live.character.appearance = AppearanceKind::Cameras;
  readBody(in, at, live.character);
  readStream(in, at + "/live", live);
  if (!in.ok()) return invalidLive(in.problem());
  return live;
}

}  // namespace fourdvt::package
