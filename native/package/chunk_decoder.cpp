// SPDX-License-Identifier: Apache-2.0
#include "package/chunk_decoder.h"

#include <algorithm>
#include <optional>

#include "base/bytes.h"
#include "package/character.h"
#include "package/label_model.h"
#include "package/position_model.h"

namespace fourdvt::package {
namespace {

Error invalid(const char* what) {
  return {ErrorId::StreamInvalid, std::string("GOP chunk: ") + what + "; the .bin file is damaged, upload it again"};
}

class FrameByFrame final : public ChunkDecoder {
 public:
  FrameByFrame(const ChunkFrames& counts, const ChunkMesh& mesh, std::span<const uint8_t> positions,
               std::span<const uint8_t> labels, uint32_t base_scale)
      : frames_(counts),
        position_bits_(positions),
        label_bits_(labels),
        position_model_(position_bits_, mesh, base_scale),
        label_model_(label_bits_, mesh, counts.layer_count) {}

  Status decodeTo(uint32_t frame) override {
    const uint32_t end = std::min(frame, frames_.frame_count - 1) + 1;
    while (!broken_ && decoded_ < end) {
      broken_ = decodeNext();
      if (broken_) break;
      ++decoded_;
    }
    if (broken_) return invalid(broken_);
    return {};
  }
  uint32_t decodedCount() const override { return decoded_; }
  const ChunkFrames& frames() const override { return frames_; }
  ChunkFrames take() override { return std::move(frames_); }

 private:
  // Null, or what is wrong. Memory grows with the frames that the bytes really hold.
  const char* decodeNext() {
    const size_t vertices = frames_.vertex_count, slots = size_t(frames_.layer_count) * frames_.face_count;
    frames_.positions.resize((decoded_ + 1) * vertices);
    frames_.labels.resize((decoded_ + 1) * slots);
    if (!position_model_.frame(&frames_.positions[decoded_ * vertices]) || position_bits_.overrun())
      return "positions do not decode";
    label_model_.frame(&frames_.labels[decoded_ * slots]);
    if (label_bits_.overrun()) return "labels do not decode";
    if (decoded_ + 1 < frames_.frame_count) return nullptr;
    if (!position_bits_.finished()) return "positions do not decode";
    return label_bits_.finished() ? nullptr : "labels do not decode";
  }

  ChunkFrames frames_;
  BinaryDecoder position_bits_, label_bits_;
  PositionModel<BinaryDecoder> position_model_;
  LabelModel<BinaryDecoder> label_model_;
  uint32_t decoded_ = 0;
  const char* broken_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<ChunkDecoder>> ChunkDecoder::open(std::span<const uint8_t> bytes, const StreamIndex& index,
                                                         uint32_t chunk, const ChunkMesh& mesh) {
  if (chunk >= index.chunks.size()) return invalid("no such GOP");
  const ChunkFrames counts{
      index.chunks[chunk].frame_count, index.vertex_count, index.face_count, index.layer_count, {}, {}};
  if (counts.vertex_count != mesh.vertexCount() || counts.face_count != mesh.faceCount() || counts.layer_count == 0 ||
      counts.layer_count > uint32_t(kMaxLayers) || counts.frame_count == 0)
    return invalid("frame, vertex, face or layer count is not the mesh's");
  ByteReader in(bytes);
  const uint32_t position_bytes = in.u32(), label_bytes = in.u32();
  ByteReader positions(in.bytes(position_bytes));
  const auto labels = in.bytes(label_bytes);
  if (!in.ok() || in.remaining() != 0) return invalid("length differs from its header");
  const uint32_t base_scale = positions.u32();
  if (!positions.ok()) return invalid("positions do not decode");
  const auto coded = positions.bytes(positions.remaining());
  return std::unique_ptr<ChunkDecoder>(std::make_unique<FrameByFrame>(counts, mesh, coded, labels, base_scale));
}

Result<ChunkFrames> decodeChunk(std::span<const uint8_t> bytes, const StreamIndex& index, uint32_t chunk,
                                const ChunkMesh& mesh) {
  auto decoder = ChunkDecoder::open(bytes, index, chunk, mesh);
  if (!decoder) return decoder.error();
  FOURDVT_TRY(decoder.value()->decodeTo(index.chunks[chunk].frame_count));
  return decoder.value()->take();
}

}  // namespace fourdvt::package
