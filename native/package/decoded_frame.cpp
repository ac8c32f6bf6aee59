// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include "package/chunk_counts.h"
#include "package/chunk_decoder.h"

namespace fourdvt::package {
namespace {

template <class Value>
void put(const std::vector<Value>& values, uint8_t*& to) {
  if (!values.empty()) std::memcpy(to, values.data(), values.size() * sizeof(Value));
  to += values.size() * sizeof(Value);
}

template <class Value>
void takeValues(const uint8_t*& from, size_t count, std::vector<Value>& values) {
  values.resize(values.size() + count);
  if (count > 0) std::memcpy(values.data() + values.size() - count, from, count * sizeof(Value));
  from += count * sizeof(Value);
}

class Received final : public ChunkDecoder {
 public:
  Received(ChunkFrames begun, uint32_t decoded) : frames_(std::move(begun)), decoded_(decoded) {
    const size_t members = frames_.member_count, vertices = frames_.vertex_count;
    frames_.positions.resize(decoded * members * vertices);
    frames_.offsets.resize(size_t(decoded) * frames_.reference_count * vertices);
    frames_.alignment.resize(size_t(decoded) * frames_.alignment_count * vertices);
    frames_.root.resize(decoded * members);
    frames_.labels.resize(decoded * members * frames_.layer_count * frames_.face_count);
  }
  Status decodeTo(uint32_t) override { return {}; }
  Status step() override { return {}; }
  bool append(std::span<const uint8_t> frame) override {
    if (decoded_ == frames_.frame_count || frame.size() != decodedFrameBytes(frames_)) return false;
    const size_t members = frames_.member_count, vertices = frames_.vertex_count;
    const size_t roots = members * sizeof(glm::vec3), labels = members * frames_.layer_count * frames_.face_count;
    std::vector<glm::vec3> root(members);
    std::memcpy(root.data(), frame.data() + frame.size() - labels - roots, roots);
    if (!std::all_of(root.begin(), root.end(), validRoot)) return false;
    const uint8_t* from = frame.data();
    takeValues(from, members * vertices, frames_.positions);
    takeValues(from, frames_.reference_count * vertices, frames_.offsets);
    takeValues(from, frames_.alignment_count * vertices, frames_.alignment);
    takeValues(from, members, frames_.root);
    takeValues(from, labels, frames_.labels);
    ++decoded_;
    return true;
  }
  uint32_t decodedCount() const override { return decoded_; }
  const ChunkFrames& frames() const override { return frames_; }
  ChunkFrames take() override { return std::move(frames_); }

 private:
  ChunkFrames frames_;
  uint32_t decoded_ = 0;
};

}  // namespace

void writeDecodedFrame(const ChunkFrames& frame, std::vector<uint8_t>& out) {
  out.resize(static_cast<size_t>(frame.bytes()));
  uint8_t* to = out.data();
  put(frame.positions, to);
  put(frame.offsets, to);
  put(frame.alignment, to);
  put(frame.root, to);
  put(frame.labels, to);
}

std::unique_ptr<ChunkDecoder> receivedChunk(const StreamIndex& index, uint32_t chunk) {
  ChunkFrames counts;
  counts.frame_count = index.chunks[chunk].frame_count;
  copyCounts(index, counts);
  return receivedChunk(std::move(counts), 0);
}

std::unique_ptr<ChunkDecoder> receivedChunk(ChunkFrames begun, uint32_t frames) {
  return std::make_unique<Received>(std::move(begun), frames);
}

}  // namespace fourdvt::package
