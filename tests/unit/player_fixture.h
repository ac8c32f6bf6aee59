// SPDX-License-Identifier: Apache-2.0
// A tiny character in memory whose every part names its frame: a sample's bytes, a picture's barcode, vertex 0's x.
// And a null device that remembers which frame each texture holds, so that a draw shows whether pixels and geometry
// belong together.
#pragma once

#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "package/barcode.h"
#include "package/base_mesh.h"
#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::testing {

constexpr float kStep_m = 0.001f;
constexpr int kFrameStride = 10;  // vertex 0's x = kStep_m * kFrameStride * (frame + 1000 * sequence)
constexpr int kSequenceFrames = 1000;

struct FakeSequence {
  std::string name;
  uint32_t frames, gop;
  double fps;
  bool loop;
  int width, height;  // of the picture; at least 192 × 8
};

struct FakeCharacter {
  std::map<std::string, std::vector<uint8_t>> files;
  FlatJson manifest;
  std::vector<FakeSequence> sequences;
};

inline package::EncodedBaseMesh fakeMesh() {
  MeshTopology t;
  Positions positions;
  for (int i = 0; i < 8; ++i) {
    positions.emplace_back(0.1f * (i / 2), 0.3f * (i % 2), 0.02f * i);
    t.uvs.emplace_back(0.25f * (i / 2), float(i % 2));
  }
  for (uint32_t i = 0; i + 2 < 8; ++i)
    t.face_vertices.push_back(i % 2 ? glm::uvec3(i, i + 2, i + 1) : glm::uvec3(i, i + 1, i + 2));
  t.face_uvs = t.face_vertices;
  t.vertex_count = 8;
  return package::encodeBaseMesh(t, positions).take();
}

// I P B B P B B …: presentation indices of a GOP in decoding order.
inline std::vector<uint32_t> decodingOrder(uint32_t count) {
  std::vector<uint32_t> order{0};
  for (uint32_t next = 1; next < count;) {
    const uint32_t anchor = std::min(next + 2, count - 1);
    order.push_back(anchor);
    for (uint32_t b = next; b < anchor; ++b) order.push_back(b);
    next = anchor + 1;
  }
  return order;
}

// A sample's first bytes: sequence, frame, key.
inline std::vector<uint8_t> fakeSample(uint32_t sequence, uint32_t frame, bool key) {
  std::vector<uint8_t> bytes(key ? 900 : 120 + frame % 50, 0xee);
  std::memcpy(bytes.data(), &sequence, 4);
  std::memcpy(bytes.data() + 4, &frame, 4);
  bytes[8] = key;
  return bytes;
}

class FakeBuilder {
 public:
  FakeCharacter build(std::vector<FakeSequence> sequences) {
    out_.sequences = std::move(sequences);
    const package::EncodedBaseMesh mesh = fakeMesh();
    vertices_ = mesh.decoded.topology.vertex_count;
    faces_ = mesh.decoded.topology.faceCount();
    chunk_mesh_ = package::makeChunkMesh(mesh.decoded);
    out_.files["mesh.bin"] = mesh.bytes;
    out_.manifest.set("/asset/version", std::string("2.0"));
    set("/version", 1.0), set("/name", std::string("fake")), set("/layerCount", 1.0);
    set("/vertexCount", double(vertices_)), set("/faceCount", double(faces_));
    set("/mesh/uri", std::string("mesh.bin")), set("/mesh/byteOffset", 0.0),
        set("/mesh/byteLength", double(mesh.bytes.size()));
    set("/poster/uri", std::string("poster.webp")), set("/groundY", 0.0);
    for (int i = 0; i < 3; ++i)
      set("/bounds/min/" + std::to_string(i), -1.0), set("/bounds/max/" + std::to_string(i), 2.0);
    camera();
    for (uint32_t s = 0; s < out_.sequences.size(); ++s) sequence(s);
    return std::move(out_);
  }

 private:
  void set(const std::string& field, FlatJson::Value value) {
    out_.manifest.set(std::string("/extensions/") + package::kExtensionName + field, std::move(value));
  }
  void camera() {
    const std::string at = "/cameras/0";
    set(at + "/name", std::string("cam00"));
    for (const char* field : {"/width", "/height", "/fx", "/fy", "/cx", "/cy"}) set(at + field, 100.0);
    for (int i = 0; i < 16; ++i) set(at + "/camFromWorld/" + std::to_string(i), i % 5 ? 0.0 : 1.0);
  }
  void sequence(uint32_t s) {
    const FakeSequence& q = out_.sequences[s];
    package::StreamIndex index{q.frames, vertices_, faces_, 1, {}, kStep_m, {}, {{}}};
    std::vector<std::vector<uint8_t>> chunks;
    std::vector<uint8_t> video(500, 0);  // an mp4 has something in front
    for (uint32_t first = 0; first < q.frames; first += q.gop) {
      const uint32_t count = std::min(q.gop, q.frames - first);
      chunks.push_back(chunk(s, first, count));
      index.chunks.push_back({first, count, 0, uint32_t(chunks.back().size())});
      package::SampleTable& table = index.renditions[0];
      table.decoder_description = {9, uint8_t(s)};
      table.chunk_first_sample.push_back(uint32_t(table.samples.size()));
      for (uint32_t i : decodingOrder(count)) {
        const std::vector<uint8_t> bytes = fakeSample(s, first + i, i == 0);
        table.samples.push_back({video.size(), uint32_t(bytes.size()), first + i, i == 0});
        video.insert(video.end(), bytes.begin(), bytes.end());
      }
    }
    index.renditions[0].chunk_first_sample.push_back(q.frames);
    uint64_t offset = package::writeStreamHeader(index).size();
    const double header_bytes = double(offset);
    for (package::ChunkEntry& entry : index.chunks) entry.offset = offset, offset += entry.bytes;
    std::vector<uint8_t> stream = package::writeStreamHeader(index);
    for (const auto& bytes : chunks) stream.insert(stream.end(), bytes.begin(), bytes.end());
    describe(s, q, double(stream.size()), header_bytes, double(video.size()));
    out_.files[q.name + ".bin"] = std::move(stream);
    out_.files[q.name + ".mp4"] = std::move(video);
  }
  std::vector<uint8_t> chunk(uint32_t s, uint32_t first, uint32_t count) {
    package::ChunkFrames frames{count, vertices_, faces_, 1, {}, {}};
    for (uint32_t f = 0; f < count; ++f) {
      for (uint32_t v = 0; v < vertices_; ++v) {
        frames.positions.emplace_back(kFrameStride * int(first + f + kSequenceFrames * s), int(v * 7), int(v * v));
      }
      frames.labels.insert(frames.labels.end(), faces_, 0);
    }
    return package::encodeChunk(frames, chunk_mesh_).take();
  }
  void describe(uint32_t s, const FakeSequence& q, double stream_bytes, double header_bytes, double video_bytes) {
    const std::string at = "/sequences/" + std::to_string(s), r = at + "/renditions/0";
    set(at + "/name", q.name), set(at + "/frameCount", double(q.frames)), set(at + "/fps", q.fps),
        set(at + "/loop", q.loop);
    for (int i = 0; i < 3; ++i) set(at + "/rootVelocity/" + std::to_string(i), 0.0);
    set(at + "/stream/uri", q.name + ".bin"), set(at + "/stream/byteLength", stream_bytes);
    set(at + "/stream/headerLength", header_bytes);
    set(r + "/uri", q.name + ".mp4"), set(r + "/byteLength", video_bytes),
        set(r + "/codec", std::string("avc1.640028"));
    set(r + "/width", double(q.width)), set(r + "/height", double(q.height));
    const double layer[4] = {0, 0, 4, 4}, strip[4] = {0, 4, 128, 4};
    for (int i = 0; i < 4; ++i) {
      set(r + "/layers/0/" + std::to_string(i), layer[i]);
      set(r + "/barcode/rect/" + std::to_string(i), strip[i]);
    }
    set(r + "/barcode/cellSize", 4.0);
  }

  FakeCharacter out_;
  uint32_t vertices_ = 0, faces_ = 0;
  package::ChunkMesh chunk_mesh_;
};

inline package::BarcodeStrip fakeStrip() { return {{0, 4, 128, 4}, 4}; }

// Forwards to the null device. Tags textures by what was uploaded; reads the tags when they are drawn together.
class TaggingDevice final : public gpu::Device {
 public:
  struct Drawn {
    int picture_frame = -1, geometry_frame = -1, geometry_sequence = -1, picture_width = 0;
  };
  Drawn drawn;

  const gpu::Caps& caps() const override { return null_->caps(); }
  Result<gpu::TextureId> createTexture(const gpu::TextureDesc& desc) override {
    auto made = null_->createTexture(desc);
    if (made.ok()) descs_[made.value()] = desc;
    return made;
  }
  void updateTexture(gpu::TextureId texture, int layer, int x, int y, int width, int height, const void* pixels,
                     int stride_bytes) override {
    null_->updateTexture(texture, layer, x, y, width, height, pixels, stride_bytes);
    const gpu::TextureDesc& desc = descs_[texture];
    if (desc.format == gpu::PixelFormat::RGBA32F) x_of_[texture] = *static_cast<const float*>(pixels);
    if (desc.format != gpu::PixelFormat::R8 || width < 128 || height < 8) return;
    const I420View view{width,   height,  static_cast<const uint8_t*>(pixels),
                        nullptr, nullptr, stride_bytes ? stride_bytes : width,
                        0,       0};
    const auto frame = package::readBarcode(fakeStrip(), view);
    frame_of_[texture] = frame ? int(*frame) : -1;
  }
  void draw(const gpu::Draw& call) override {
    null_->draw(call);
    for (const gpu::TextureBinding& binding : call.textures) {
      const std::string sampler = binding.sampler;
      if (sampler == "u_picture_y") {
        drawn.picture_frame = frame_of_[binding.texture];
        drawn.picture_width = descs_[binding.texture].width;
      } else if (sampler == "u_positions_normals") {
        const int tag = int(std::lround(x_of_[binding.texture] / (kStep_m * kFrameStride)));
        drawn.geometry_frame = tag % kSequenceFrames;
        drawn.geometry_sequence = tag / kSequenceFrames;
      }
    }
  }
  void generateMipmaps(gpu::TextureId t) override { null_->generateMipmaps(t); }
  void destroyTexture(gpu::TextureId t) override { null_->destroyTexture(t); }
  Result<gpu::ProgramId> createProgram(std::string_view label, std::string_view vertex, std::string_view fragment,
                                       std::string_view defines) override {
    return null_->createProgram(label, vertex, fragment, defines);
  }
  void destroyProgram(gpu::ProgramId p) override { null_->destroyProgram(p); }
  Result<gpu::TargetId> createTarget(const gpu::TargetDesc& desc) override { return null_->createTarget(desc); }
  void destroyTarget(gpu::TargetId t) override { null_->destroyTarget(t); }
  void beginPass(const gpu::Pass& pass) override { null_->beginPass(pass); }
  void endPass() override { null_->endPass(); }
  void blit(gpu::TargetId from, gpu::TargetId to, int w, int h, int x, int y) override {
    null_->blit(from, to, w, h, x, y);
  }
  Status readPixels(gpu::TargetId t, gpu::PixelFormat f, int x, int y, int w, int h, void* out) override {
    return null_->readPixels(t, f, x, y, w, h, out);
  }
  uint32_t nativeTexture(gpu::TextureId t) const override { return null_->nativeTexture(t); }
  void invalidateState() override { null_->invalidateState(); }
  const gpu::Counters& counters() const override { return null_->counters(); }
  void resetCounters() override { null_->resetCounters(); }
  std::string takeErrors() override { return null_->takeErrors(); }

 private:
  std::unique_ptr<gpu::Device> null_ = gpu::createNullDevice();
  std::map<gpu::TextureId, gpu::TextureDesc> descs_;
  std::map<gpu::TextureId, int> frame_of_;
  std::map<gpu::TextureId, float> x_of_;
};

}  // namespace fourdvt::testing
