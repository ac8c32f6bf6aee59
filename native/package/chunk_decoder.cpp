// SPDX-License-Identifier: Apache-2.0
#include "package/chunk_decoder.h"

#include <algorithm>
#include <utility>

#include "base/bytes.h"
#include "package/chunk_counts.h"
#include "package/field_model.h"
#include "package/label_model.h"
#include "package/position_model.h"

namespace fourdvt::package {
namespace {

// One coded part of a chunk, decoded frame by frame in order.
class Part {
 public:
  explicit Part(std::span<const uint8_t> bytes) : bits_(bytes) {}
  virtual ~Part() = default;
  // Appends one frame of the part to `out`. False: corrupt, or bytes left after the last frame.
  bool decode(ChunkFrames& out, bool last) {
    return decodeFrame(out) && !bits_.overrun() && (!last || bits_.finished());
  }

 protected:
  virtual bool decodeFrame(ChunkFrames& out) = 0;
  BinaryDecoder bits_;
};

// Makes room for `count` more values; returns the first.
template <class Value>
Value* append(std::vector<Value>& values, size_t count) {
  values.resize(values.size() + count);
  return values.data() + values.size() - count;
}

class PositionPart final : public Part {
 public:
  PositionPart(ByteReader bytes, const ChunkMesh& mesh) : PositionPart({bytes.u32(), bytes.u32()}, bytes, mesh) {}

 private:
  PositionPart(const PositionScale& scale, ByteReader& bytes, const ChunkMesh& mesh)
      : Part(bytes.bytes(bytes.remaining())), model_(bits_, mesh, scale) {}
  bool decodeFrame(ChunkFrames& out) override { return model_.frame(append(out.positions, out.vertex_count)); }
  PositionModel<BinaryDecoder> model_;
};

class LabelPart final : public Part {
 public:
  LabelPart(std::span<const uint8_t> bytes, const ChunkMesh& mesh, uint32_t layers)
      : Part(bytes), model_(bits_, mesh, layers) {}

 private:
  bool decodeFrame(ChunkFrames& out) override {
    model_.frame(append(out.labels, size_t(out.layer_count) * out.face_count));
    return true;
  }
  LabelModel<BinaryDecoder> model_;
};

template <int N>
class FieldPart final : public Part {
 public:
  using Field = std::vector<glm::vec<N, int>> ChunkFrames::*;
  FieldPart(ByteReader bytes, const ChunkMesh& mesh, Field field) : FieldPart(bytes.u32(), bytes, mesh, field) {}

 private:
  FieldPart(uint32_t residual_step, ByteReader& bytes, const ChunkMesh& mesh, Field field)
      : Part(bytes.bytes(bytes.remaining())), model_(bits_, mesh, N, residual_step), field_(field) {}
  bool decodeFrame(ChunkFrames& out) override { return model_.frame(append(out.*field_, out.vertex_count)); }
  FieldModel<BinaryDecoder> model_;
  Field field_;
};

class FrameByFrame final : public ChunkDecoder {
 public:
  FrameByFrame(const ChunkFrames& counts, const ChunkMesh& mesh) : frames_(counts), mesh_(mesh) {}

  // False: the part lengths disagree with the byte count.
  bool open(std::span<const uint8_t> bytes) {
    ByteReader lengths(bytes), in(bytes);
    in.bytes(size_t(4) * partCount(frames_));
    const auto next = [&] { return in.bytes(lengths.u32()); };
    for (uint32_t m = 0; m < frames_.member_count; ++m) {
      parts_.push_back(std::make_unique<PositionPart>(ByteReader(next()), mesh_));
      parts_.push_back(std::make_unique<LabelPart>(next(), mesh_, frames_.layer_count));
    }
    for (uint32_t r = 0; r < frames_.reference_count; ++r)
      parts_.push_back(std::make_unique<FieldPart<3>>(ByteReader(next()), mesh_, &ChunkFrames::offsets));
    for (uint32_t a = 0; a < frames_.alignment_count; ++a)
      parts_.push_back(std::make_unique<FieldPart<2>>(ByteReader(next()), mesh_, &ChunkFrames::alignment));
    root_ = ByteReader(in.bytes(size_t(12) * frames_.frame_count * frames_.member_count));
    return in.ok() && in.remaining() == 0;
  }

  Status decodeTo(uint32_t frame) override {
    const uint32_t end = std::min(frame, frames_.frame_count - 1) + 1;
    Status status = checkDecoded();
    while (status.ok() && decoded_ < end) status = step();
    return status;
  }
  Status step() override {
    if (!broken_ && decoded_ < frames_.frame_count) broken_ = !decodePart();
    return checkDecoded();
  }
  uint32_t decodedCount() const override { return decoded_; }
  const ChunkFrames& frames() const override { return frames_; }
  ChunkFrames take() override {
    ChunkFrames counts;
    counts.frame_count = frames_.frame_count;
    copyCounts(frames_, counts);
    return std::exchange(frames_, counts);
  }

 private:
  Status checkDecoded() const {
    if (broken_) return invalidChunk("positions, labels or fields do not decode");
    return {};
  }
  // Decodes one frame at a time, so that memory grows only with frames present in the bytes.
  bool decodePart() {
    const bool last = decoded_ + 1 == frames_.frame_count;
    if (!parts_[part_]->decode(frames_, last)) return false;
    if (++part_ < parts_.size()) return true;
    part_ = 0;
    for (uint32_t m = 0; m < frames_.member_count; ++m) {
      glm::vec3& root = frames_.root.emplace_back();
      for (int k = 0; k < 3; ++k) root[k] = root_.f32();
      if (!validRoot(root)) return false;
    }
    ++decoded_;
    if (last) parts_.clear();  // models are larger than the frames
    return true;
  }

  ChunkFrames frames_;
  const ChunkMesh& mesh_;
  std::vector<std::unique_ptr<Part>> parts_;
  ByteReader root_{{}};
  size_t part_ = 0;  // next part to decode, of the next frame
  uint32_t decoded_ = 0;
  bool broken_ = false;
};

}  // namespace

Result<std::unique_ptr<ChunkDecoder>> ChunkDecoder::open(std::span<const uint8_t> bytes, const StreamIndex& index,
                                                         uint32_t chunk, const ChunkMesh& mesh) {
  if (chunk >= index.chunks.size()) return invalidChunk("no such GOP");
  ChunkFrames counts;
  counts.frame_count = index.chunks[chunk].frame_count;
  copyCounts(index, counts);
  if (counts.vertex_count != mesh.vertexCount() || counts.face_count != mesh.faceCount() || counts.frame_count == 0 ||
      !validCounts(counts))
    return invalidChunk("frame, vertex, face, layer or member count is not the mesh's");
  auto decoder = std::make_unique<FrameByFrame>(counts, mesh);
  if (!decoder->open(bytes)) return invalidChunk("length differs from its header");
  return std::unique_ptr<ChunkDecoder>(std::move(decoder));
}

Result<ChunkFrames> decodeChunk(std::span<const uint8_t> bytes, const StreamIndex& index, uint32_t chunk,
                                const ChunkMesh& mesh) {
  auto decoder = ChunkDecoder::open(bytes, index, chunk, mesh);
  if (!decoder) return decoder.error();
  FOURDVT_TRY(decoder.value()->decodeTo(index.chunks[chunk].frame_count));
  return decoder.value()->take();
}

}  // namespace fourdvt::package
