// SPDX-License-Identifier: Apache-2.0
#include "package/stream_file.h"

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "package/chunk_counts.h"

namespace fourdvt::package {
namespace {

constexpr uint32_t kMagic = 0x53564434;                                   // "4DVS"
constexpr uint16_t kVersion = 7, kCameraVersion = 8, kCoarseVersion = 9;  // 9: as 7, with coarse chunks
constexpr uint32_t kKeyBit = 0x80000000u;
constexpr uint32_t kMaxChunkFrames = 65535;
constexpr uint64_t kMaxOffset = 1ull << 53;

Error invalidHeader(const char* what) {
  return {ErrorId::StreamInvalid, std::string("stream header: ") + what + "; the .bin file is damaged or incomplete"};
}

void writeRendition(ByteWriter& out, const SampleTable& table, const std::vector<ChunkEntry>& chunks) {
  out.u32(static_cast<uint32_t>(table.decoder_description.size()));
  out.bytes(table.decoder_description);
  for (size_t c = 0; c < chunks.size(); ++c) {
    const uint32_t first = table.chunk_first_sample[c];
    out.u64(table.samples[first].offset);
    out.u64(table.chunk_hash[c]);
    for (uint32_t s = first; s < table.chunk_first_sample[c + 1]; ++s) {
      const VideoSample& sample = table.samples[s];
      out.u32(sample.bytes | (sample.key ? kKeyBit : 0));
      out.u16(static_cast<uint16_t>(sample.frame - chunks[c].first_frame));
    }
  }
}

// Reads one chunk's samples. False unless they cover its frames exactly once and start with a key.
bool readChunkSamples(ByteReader& in, const ChunkEntry& chunk, SampleTable& table) {
  std::vector<uint8_t> seen(chunk.frame_count);
  uint64_t offset = in.u64();
  table.chunk_hash.push_back(in.u64());
  for (uint32_t i = 0; i < chunk.frame_count; ++i) {
    const uint32_t bytes_and_key = in.u32();
    const uint32_t frame = in.u16();
    VideoSample sample{offset, bytes_and_key & ~kKeyBit, chunk.first_frame + frame, (bytes_and_key & kKeyBit) != 0};
    if (!in.ok() || frame >= chunk.frame_count || seen[frame] || sample.bytes == 0) return false;
    if (i == 0 && !sample.key) return false;
    seen[frame] = 1;
    offset += sample.bytes;
    if (offset > kMaxOffset) return false;
    table.samples.push_back(sample);
  }
  return true;
}

Status readRendition(ByteReader& in, StreamIndex& index) {
  SampleTable table;
  const auto description = in.bytes(in.u32());
  table.decoder_description.assign(description.begin(), description.end());
  for (const ChunkEntry& chunk : index.chunks) {
    table.chunk_first_sample.push_back(static_cast<uint32_t>(table.samples.size()));
    // A sample takes 6 bytes: counts beyond the span's length are refused before memory grows.
    if (!in.ok() || in.remaining() / 6 < chunk.frame_count) return invalidHeader("truncated sample table");
    if (!readChunkSamples(in, chunk, table)) return invalidHeader("sample table does not match the frames");
  }
  table.chunk_first_sample.push_back(static_cast<uint32_t>(table.samples.size()));
  index.renditions.push_back(std::move(table));
  return {};
}

void writePlace(ByteWriter& out, const ChunkEntry& chunk) {
  out.u32(chunk.bytes);
  out.u64(chunk.offset);
  out.u64(chunk.hash);
}

void readPlace(ByteReader& in, ChunkEntry& chunk) {
  chunk.bytes = in.u32();
  chunk.offset = in.u64();
  chunk.hash = in.u64();
}

bool validPlace(const ChunkEntry& chunk, size_t header_bytes) {
  return chunk.bytes > 0 && chunk.offset >= header_bytes && chunk.offset <= kMaxOffset;
}

Status readChunks(ByteReader& in, StreamIndex& index, size_t header_bytes) {
  const uint32_t count = in.u32();
  if (!in.ok() || count == 0 || count > index.frame_count || in.remaining() / 24 < count)
    return invalidHeader("bad GOP count");
  uint64_t next_frame = 0;
  for (uint32_t c = 0; c < count; ++c) {
    ChunkEntry chunk;
    chunk.first_frame = static_cast<uint32_t>(next_frame);
    chunk.frame_count = in.u32();
    readPlace(in, chunk);
    next_frame += chunk.frame_count;
    if (chunk.frame_count == 0 || chunk.frame_count > kMaxChunkFrames || next_frame > index.frame_count) {
      return invalidHeader("GOPs do not match the frame count");
    }
    if (!validPlace(chunk, header_bytes)) return invalidHeader("bad GOP range");
    index.chunks.push_back(chunk);
  }
  if (next_frame != index.frame_count) return invalidHeader("GOPs do not cover all frames");
  return {};
}

Status readCoarseChunks(ByteReader& in, StreamIndex& index, size_t header_bytes) {
  index.coarse_chunks = index.chunks;
  for (ChunkEntry& chunk : index.coarse_chunks) {
    readPlace(in, chunk);
    if (!in.ok() || !validPlace(chunk, header_bytes)) return invalidHeader("bad range of a coarse chunk");
  }
  return {};
}

Status readCounts(ByteReader& in, StreamIndex& index, size_t span_bytes, uint16_t& version) {
  if (in.u32() != kMagic) return invalidHeader("not a fourdvt stream");
  version = in.u16();
  in.u16();
  if (version < kVersion) {
    return Error{ErrorId::Unsupported, "stream header: version " + std::to_string(version) +
                                           " of an earlier fourdvt; bake the character again"};
  }
  if (version > kCoarseVersion) return Error{ErrorId::Unsupported, "stream header: unknown version; update the player"};
  if (in.u32() != span_bytes) return invalidHeader("length differs from the manifest's");
  index.frame_count = in.u32();
  index.vertex_count = in.u32();
  index.face_count = in.u32();
  index.layer_count = in.u32();
  index.member_count = in.u32();
  index.reference_count = in.u32();
  index.alignment_count = in.u32();
  for (int i = 0; i < 3; ++i) index.position_origin[i] = in.f32();
  index.position_step_m = in.f32();
  index.alignment_step_m = in.f32();
  if (!in.ok()) return invalidHeader("truncated");
  const bool counts_ok = index.frame_count >= 1 && index.frame_count <= kMaxFrames && index.vertex_count >= 3 &&
                         index.vertex_count <= kMaxCount && index.face_count >= 1 && index.face_count <= kMaxCount &&
                         (version == kCameraVersion ? isCameraStream(index) : validCounts(index));
  if (!counts_ok) return invalidHeader("counts out of range");
  const glm::vec3& o = index.position_origin;
  const auto fits = [](float metres) { return std::abs(metres) <= 1e6f; };  // keeps origin + step · q finite
  if (!fits(o.x) || !fits(o.y) || !fits(o.z) || !(index.position_step_m > 0) || !fits(index.position_step_m) ||
      !fits(index.alignment_step_m) || (index.alignment_count > 0 && !(index.alignment_step_m > 0))) {
    return invalidHeader("bad quantisation");
  }
  return {};
}

}  // namespace

bool keepsMemoryLimits(const StreamIndex& index) {
  const uint64_t frame_bytes = decodedFrameBytes(index);
  for (const ChunkEntry& chunk : index.chunks)
    if (chunk.bytes > kMaxChunkBytes || chunk.frame_count * frame_bytes > kMaxDecodedChunkBytes) return false;
  for (const ChunkEntry& chunk : index.coarse_chunks)
    if (chunk.bytes > kMaxChunkBytes) return false;
  for (const SampleTable& table : index.renditions) {
    for (uint32_t c = 0; c < index.chunks.size(); ++c)
      if (table.videoOf(c).bytes > kMaxGopVideoBytes) return false;
  }
  return true;
}

StreamIndex StreamIndex::coarse() const {
  StreamIndex out = *this;
  out.chunks = std::move(out.coarse_chunks);
  out.coarse_chunks.clear();
  out.renditions.clear();
  return out;
}

ByteSpan SampleTable::videoOf(uint32_t chunk) const {
  const VideoSample& first = samples[chunk_first_sample[chunk]];
  const VideoSample& last = samples[chunk_first_sample[chunk + 1] - 1];
  return {first.offset, last.offset + last.bytes - first.offset};
}

uint32_t StreamIndex::chunkOfFrame(uint32_t frame) const {
  auto it = std::upper_bound(chunks.begin(), chunks.end(), frame,
                             [](uint32_t f, const ChunkEntry& c) { return f < c.first_frame; });
  return it == chunks.begin() ? 0 : static_cast<uint32_t>(it - chunks.begin() - 1);
}

std::vector<uint8_t> writeStreamHeader(const StreamIndex& index) {
  ByteWriter body;
  body.u32(index.frame_count);
  body.u32(index.vertex_count);
  body.u32(index.face_count);
  body.u32(index.layer_count);
  body.u32(index.member_count);
  body.u32(index.reference_count);
  body.u32(index.alignment_count);
  for (int i = 0; i < 3; ++i) body.f32(index.position_origin[i]);
  body.f32(index.position_step_m);
  body.f32(index.alignment_step_m);
  body.u32(static_cast<uint32_t>(index.chunks.size()));
  for (const ChunkEntry& chunk : index.chunks) {
    body.u32(chunk.frame_count);
    writePlace(body, chunk);
  }
  body.u32(static_cast<uint32_t>(index.renditions.size()));
  for (const SampleTable& table : index.renditions) writeRendition(body, table, index.chunks);
  const bool coarse = !index.coarse_chunks.empty();
  for (const ChunkEntry& chunk : index.coarse_chunks) writePlace(body, chunk);
  ByteWriter out;
  out.u32(kMagic);
  out.u16(index.layer_count == 0 ? kCameraVersion : coarse ? kCoarseVersion : kVersion);
  out.u16(0);
  out.u32(static_cast<uint32_t>(12 + body.size()));
  out.bytes(body.data());
  return out.take();
}

Result<StreamIndex> readStreamHeader(std::span<const uint8_t> bytes) {
  ByteReader in(bytes);
  StreamIndex index;
  uint16_t version = 0;
  FOURDVT_TRY(readCounts(in, index, bytes.size(), version));
  FOURDVT_TRY(readChunks(in, index, bytes.size()));
  const uint32_t renditions = in.u32();
  if (!in.ok() || renditions == 0 || renditions > kMaxRenditions) return invalidHeader("bad rendition count");
  for (uint32_t r = 0; r < renditions; ++r) FOURDVT_TRY(readRendition(in, index));
  if (version == kCoarseVersion) FOURDVT_TRY(readCoarseChunks(in, index, bytes.size()));
  if (!in.ok() || in.remaining() != 0) return invalidHeader("trailing bytes");
  if (!keepsMemoryLimits(index)) return invalidHeader("a GOP would take more memory than any should");
  return index;
}

}  // namespace fourdvt::package
