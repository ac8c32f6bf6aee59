// SPDX-License-Identifier: Apache-2.0
// Decoding of GOP chunks; chunk_encode.cpp is the mirror image. Byte layout: FORMAT.md.
#include <algorithm>
#include <cstdlib>

#include "base/bytes.h"
#include "draco/compression/decode.h"
#include "package/character.h"
#include "package/chunk_symbols.h"
#include "package/draco_guard.h"
#include "package/stream_file.h"

namespace fourdvt::package {
namespace {

constexpr uint32_t kMaxQuantised = 1u << 24;  // exact in a float

Error invalid(const char* what) {
  return {ErrorId::StreamInvalid, std::string("GOP chunk: ") + what + "; the .bin file is damaged, upload it again"};
}

std::unique_ptr<draco::PointCloud> decodePointCloud(std::span<const uint8_t> bytes, uint32_t points,
                                                    uint32_t attributes, int components) {
  if (!looksLikePointCloud(bytes, points, attributes, components)) return nullptr;
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  auto decoded = draco::Decoder().DecodePointCloudFromBuffer(&buffer);
  if (!decoded.ok() || buffer.remaining_size() != 0) return nullptr;
  auto cloud = std::move(decoded).value();
  if (cloud->num_points() != points || cloud->num_attributes() != static_cast<int32_t>(attributes)) return nullptr;
  for (uint32_t a = 0; a < attributes; ++a) {
    const auto* attribute = cloud->attribute(static_cast<int32_t>(a));
    if (attribute->size() != points || !attribute->is_mapping_identity()) return nullptr;
  }
  return cloud;
}

// Undoes the temporal prediction (see predictedPosition) with wrapping arithmetic.
Status decodePositions(std::span<const uint8_t> bytes, ChunkFrames& out) {
  const auto cloud = decodePointCloud(bytes, out.vertex_count, out.frame_count, 3);
  if (!cloud) return invalid("positions do not decode");
  const size_t vertices = out.vertex_count;
  out.positions.resize(vertices * out.frame_count);
  for (uint32_t f = 0; f < out.frame_count; ++f) {
    const auto* residuals = cloud->attribute(static_cast<int32_t>(f));
    for (uint32_t v = 0; v < vertices; ++v) {
      glm::ivec3 residual;
      residuals->GetValue(draco::AttributeValueIndex(v), &residual[0]);
      const glm::uvec3 q = predictedPosition(out.positions.data(), f, v, vertices) + glm::uvec3(residual);
      for (int c = 0; c < 3; ++c) {
        if (q[c] + kMaxQuantised > 2 * kMaxQuantised) return invalid("a position is out of range");
      }
      out.positions[f * vertices + v] = glm::ivec3(q);
    }
  }
  return {};
}

Status checkPalette(std::span<const uint8_t> bytes) {
  for (uint8_t label : bytes) {
    if (label >= kMaxCameras && label != kNoCamera) return invalid("a label is out of range");
  }
  return {};
}

// Label tuples by palette rank: see chunk_symbols.h.
Status decodeLabels(std::span<const uint8_t> bytes, std::span<const uint8_t> palette, ChunkFrames& out) {
  const auto cloud = decodePointCloud(bytes, out.face_count, out.frame_count, 1);
  if (!cloud) return invalid("labels do not decode");
  const uint32_t palette_count = static_cast<uint32_t>(palette.size() / out.layer_count);
  const size_t faces = out.face_count;
  out.labels.resize(faces * out.layer_count * out.frame_count);
  std::vector<uint32_t> rank(faces, 0);
  for (uint32_t f = 0; f < out.frame_count; ++f) {
    const auto* symbols = cloud->attribute(static_cast<int32_t>(f));
    for (uint32_t i = 0; i < faces; ++i) {
      int32_t symbol = 0;
      symbols->GetValue(draco::AttributeValueIndex(i), &symbol);
      if (symbol == kSameAsPreviousFrame && f == 0) return invalid("a label refers to a frame before the first");
      if (symbol == kSameAsPreviousFace && i == 0) return invalid("a label refers to a face before the first");
      if (symbol == kSameAsPreviousFace) rank[i] = rank[i - 1];
      if (symbol >= kFirstRank || symbol < 0) rank[i] = static_cast<uint32_t>(symbol) - kFirstRank;
      if (rank[i] >= palette_count) return invalid("a label refers past the palette");
      for (uint32_t l = 0; l < out.layer_count; ++l) {
        out.labels[(size_t(f) * out.layer_count + l) * faces + i] = palette[size_t(rank[i]) * out.layer_count + l];
      }
    }
  }
  return {};
}

}  // namespace

Result<ChunkFrames> decodeChunk(std::span<const uint8_t> bytes, const StreamIndex& index, uint32_t chunk) {
  if (chunk >= index.chunks.size()) return invalid("no such GOP");
  ChunkFrames out{index.chunks[chunk].frame_count, index.vertex_count, index.face_count, index.layer_count, {}, {}};
  ByteReader in(bytes);
  const uint32_t position_bytes = in.u32(), label_bytes = in.u32(), palette_count = in.u32();
  if (!in.ok() || palette_count > bytes.size() || out.layer_count == 0) return invalid("bad counts");
  const auto palette = in.bytes(size_t(palette_count) * out.layer_count);
  const auto positions = in.bytes(position_bytes);
  const auto labels = in.bytes(label_bytes);
  if (!in.ok() || in.remaining() != 0) return invalid("length differs from its header");
  FOURDVT_TRY(checkPalette(palette));
  FOURDVT_TRY(decodePositions(positions, out));
  FOURDVT_TRY(decodeLabels(labels, palette, out));
  return out;
}

}  // namespace fourdvt::package
