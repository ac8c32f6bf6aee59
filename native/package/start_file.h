// SPDX-License-Identifier: Apache-2.0
// Start file: data of the first picture, shown before any stream arrives. Contains the base mesh, a stream of one frame
// (header, chunk and key sample), and the header of the stream that follows. The manifest has the hash of the whole
// file. Byte layout: FORMAT.md.
#pragma once

#include <span>
#include <vector>

#include "package/base_mesh.h"
#include "package/character.h"
#include "package/stream_file.h"

namespace fourdvt::package {

constexpr uint32_t kStartMagic = 0x46564434;  // "4DVF"
constexpr uint16_t kStartVersion = 2;

struct StartFile {
  std::span<const uint8_t> mesh;  // mesh_code.h; span of the file's bytes
  std::vector<uint8_t> chunk, video;
  StreamIndex index;                // one frame, one GOP, one rendition
  std::span<const uint8_t> header;  // first bytes of the first sequence's .bin; empty: a player fetches them
};

// Encodes a start file. gop: first chunk of the stream, fine or coarse; index: the stream's, with that chunk's steps;
// key: first sample of the stream's first rendition; header: see StartFile. Re-encodes the geometry of one frame.
// Native only. Errors: those of ChunkDecoder; Internal.
Result<std::vector<uint8_t>> encodeStartFile(const StreamIndex& index, std::span<const uint8_t> gop,
                                             std::span<const uint8_t> key, std::span<const uint8_t> header,
                                             const BaseMesh& base);
// Overload for a character from cameras, which has no base mesh.
Result<std::vector<uint8_t>> encodeStartFile(const StreamIndex& index, std::span<const uint8_t> gop,
                                             std::span<const uint8_t> key, std::span<const uint8_t> header,
                                             const Character& character, const Sequence& sequence);
// Errors: StreamInvalid; those of readStreamHeader.
Result<StartFile> readStartFile(std::span<const uint8_t> bytes);

}  // namespace fourdvt::package
