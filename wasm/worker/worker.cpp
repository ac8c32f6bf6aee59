// SPDX-License-Identifier: Apache-2.0
// Geometry decoder of GOPs for a worker of the page: plain C functions on numbers, listed in abi.txt.
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "abi.h"
#include "package/chunk_decoder.h"

using namespace fourdvt;

namespace {

// Table of objects by number, from 1; free numbers are reused.
template <class Value>
class Numbered {
 public:
  uint32_t add(std::unique_ptr<Value> value) {
    size_t at = 0;
    while (at < values_.size() && values_[at]) ++at;
    if (at == values_.size()) values_.emplace_back();
    values_[at] = std::move(value);
    return static_cast<uint32_t>(at + 1);
  }
  Value* find(uint32_t number) { return number - 1 < values_.size() ? values_[number - 1].get() : nullptr; }
  void drop(uint32_t number) {
    if (find(number)) values_[number - 1].reset();
  }

 private:
  std::vector<std::unique_ptr<Value>> values_;
};

Numbered<package::ChunkMesh> g_meshes;
Numbered<package::ChunkDecoder> g_decoders;
std::vector<uint8_t> g_frame;
abi::DecodedFrame g_record;

template <class Value>
std::vector<Value> valuesOf(const uint8_t* bytes, uint32_t size) {
  std::vector<Value> values(size / sizeof(Value));
  if (!values.empty()) std::memcpy(values.data(), bytes, values.size() * sizeof(Value));
  return values;
}

}  // namespace

void* fdvt_worker_alloc(uint32_t size) { return std::malloc(size); }
void fdvt_worker_free(void* memory) { std::free(memory); }

uint32_t fdvt_worker_mesh(const uint8_t* faces, uint32_t faces_size, const uint8_t* base, uint32_t base_size) {
  const auto corners = valuesOf<glm::uvec3>(faces, faces_size);
  auto positions = valuesOf<glm::ivec3>(base, base_size);
  for (const glm::uvec3& face : corners)
    for (int k = 0; k < 3; ++k)
      if (face[k] >= positions.size()) return 0;
  return g_meshes.add(std::make_unique<package::ChunkMesh>(package::makeChunkMesh(corners, std::move(positions))));
}
void fdvt_worker_drop_mesh(uint32_t mesh) { g_meshes.drop(mesh); }

uint32_t fdvt_worker_open(uint32_t mesh_number, const uint8_t* chunk, uint32_t size, uint32_t frames, uint32_t layers,
                          uint32_t members, uint32_t references, uint32_t alignments) {
  const package::ChunkMesh* mesh = g_meshes.find(mesh_number);
  if (!mesh) return 0;
  package::StreamIndex index;
  index.frame_count = frames;
  index.vertex_count = mesh->vertexCount();
  index.face_count = mesh->faceCount();
  index.layer_count = layers;
  index.member_count = members;
  index.reference_count = references;
  index.alignment_count = alignments;
  index.chunks.resize(1);
  index.chunks[0].frame_count = frames;
  auto opened = package::ChunkDecoder::open({chunk, size}, index, 0, *mesh);
  return opened.ok() ? g_decoders.add(opened.take()) : 0;
}

const abi::DecodedFrame* fdvt_worker_next(uint32_t number) {
  package::ChunkDecoder* decoder = g_decoders.find(number);
  g_record = {};
  if (decoder && decoder->decodeTo(decoder->decodedCount()).ok()) {
    package::writeDecodedFrame(decoder->take(), g_frame);
    g_record.data = {g_frame.data(), static_cast<uint32_t>(g_frame.size())};
  }
  return &g_record;
}
void fdvt_worker_close(uint32_t number) { g_decoders.drop(number); }
