// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/bytes.h"
#include "base/hash.h"
#include "package/chunk_decoder.h"
#include "package/chunk_encode.h"
#include "package/chunk_mesh.h"
#include "package/mesh_code.h"
#include "package/start_file.h"
#include "package/surface_chunk.h"

namespace fourdvt::package {
namespace {

// Truncates frame-major lists to their first frame.
ChunkFrames firstFrame(ChunkFrames frames, uint32_t decoded) {
  const auto cut = [&](auto& list) { list.resize(list.size() / decoded); };
  cut(frames.positions), cut(frames.labels), cut(frames.offsets), cut(frames.alignment), cut(frames.root);
  frames.frame_count = 1;
  return frames;
}

// Table with its first sample only, a key sample of these bytes.
SampleTable firstSample(const SampleTable& table, std::span<const uint8_t> bytes) {
  SampleTable out;
  out.decoder_description = table.decoder_description;
  out.samples = {table.samples[0]};
  out.samples[0].offset = 0;
  out.chunk_first_sample = {0, 1};
  out.chunk_hash = {fnv1a(bytes)};
  return out;
}

std::vector<uint8_t> join(std::span<const uint8_t> mesh, std::span<const uint8_t> header,
                          std::span<const uint8_t> chunk, std::span<const uint8_t> video,
                          std::span<const uint8_t> stream_header) {
  ByteWriter out;
  out.u32(kStartMagic);
  out.u16(kStartVersion);
  out.u16(0);
  for (const auto part : {mesh, header, chunk, video, stream_header}) out.u32(static_cast<uint32_t>(part.size()));
  for (const auto part : {mesh, header, chunk, video, stream_header}) out.bytes(part);
  return out.take();
}

// Assembles the file; the index becomes that of one frame.
std::vector<uint8_t> finish(StreamIndex index, std::span<const uint8_t> mesh, const std::vector<uint8_t>& chunk,
                            std::span<const uint8_t> key, std::span<const uint8_t> header) {
  index.frame_count = 1;
  index.coarse_chunks.clear();
  index.chunks = {{0, 1, 0, static_cast<uint32_t>(chunk.size()), fnv1a(chunk)}};
  index.renditions = {firstSample(index.renditions[0], key)};
  index.chunks[0].offset = writeStreamHeader(index).size();  // same layout as a .bin: header, then chunk
  return join(mesh, writeStreamHeader(index), chunk, key, header);
}

QuantisedSurface quantised(const Surface& surface, const StreamIndex& index) {
  QuantisedSurface out;
  out.faces.assign(surface.faces.begin(), surface.faces.end());
  for (const glm::vec3& p : surface.positions)
    out.positions.emplace_back(
        glm::round((glm::dvec3(p) - glm::dvec3(index.position_origin)) / double(index.position_step_m)));
  return out;
}

}  // namespace

Result<std::vector<uint8_t>> encodeStartFile(const StreamIndex& index, std::span<const uint8_t> gop,
                                             std::span<const uint8_t> key, std::span<const uint8_t> header,
                                             const BaseMesh& base) {
  const ChunkMesh mesh = makeChunkMesh(base);
  FOURDVT_ASSIGN(auto decoder, ChunkDecoder::open(gop, index, 0, mesh));
  const uint32_t frames = index.chunks[0].frame_count;
  FOURDVT_TRY(decoder->decodeTo(frames - 1));
  FOURDVT_ASSIGN(const auto chunk, encodeFirstFrame(gop, firstFrame(decoder->frames(), frames), mesh));
  FOURDVT_ASSIGN(const auto coded, encodeMeshCode(base));
  return finish(index, coded, chunk, key, header);
}

Result<std::vector<uint8_t>> encodeStartFile(const StreamIndex& index, std::span<const uint8_t> gop,
                                             std::span<const uint8_t> key, std::span<const uint8_t> header,
                                             const Character& character, const Sequence& sequence) {
  FOURDVT_ASSIGN(auto decoder, SurfaceChunk::open(gop, index, 0, character, sequence));
  FOURDVT_TRY(decoder->decodeTo(0));
  const QuantisedSurface frame = quantised(decoder->surface(0), index);
  FOURDVT_ASSIGN(const auto chunk, encodeSurfaceChunk(decoder->tiles(), {&frame, 1}));
  return finish(index, {}, chunk.bytes, key, header);
}

}  // namespace fourdvt::package
