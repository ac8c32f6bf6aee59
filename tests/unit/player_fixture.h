// SPDX-License-Identifier: Apache-2.0
// A tiny character in memory whose every part identifies its frame: a sample's bytes, a picture's barcode, vertex 0's
// x. A null device that records the frame of each texture, so that a draw shows whether pixels and geometry match.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/hash.h"
#include "gpu/device.h"
#include "motion/motion_graph.h"
#include "package/barcode.h"
#include "package/base_mesh.h"
#include "package/chunk_mesh.h"
#include "package/start_file.h"
#include "package/stream_file.h"

namespace fourdvt::testing {

constexpr float kStep_m = 0.001f;
constexpr int kFrameStride = 10;  // vertex 0's x = kStep_m * kFrameStride * (frame + 1000 * sequence)
constexpr int kSequenceFrames = 1000;
constexpr int kMemberTag = 100;  // steps of vertex 1's y per member; the drawn value gives the mix of weights

struct FakeMember {
  double speed_mps = 0, duration_s = 1;
  glm::dvec3 travel{0};  // of one pass; root motion is uniform
};

struct FakeSequence {
  std::string name;
  uint32_t frames, gop;
  double fps;
  bool loop;
  int width, height;                // of the picture; minimum 192 × 8
  std::vector<FakeMember> members;  // several: a class by "speed_mps"
  uint32_t renditions = 1;          // each lower one is 16 texels narrower
  uint32_t coarse = 0;              // so many of the lowest go with coarse geometry, in steps of 4: vertex 1's y is 8
  bool heavier = false;             // the second rendition has twice the bytes of the first, the third three times
  uint32_t chosen(uint32_t rendition) const { return std::min(rendition, renditions - 1); }
  int widthOf(uint32_t rendition) const { return width - 16 * int(renditions - 1 - chosen(rendition)); }
  std::string videoOf(uint32_t rendition) const {
    return rendition + 1 < renditions ? name + "." + std::to_string(rendition) + ".mp4" : name + ".mp4";
  }
  glm::dvec3 travel(size_t member) const { return members.empty() ? glm::dvec3(0) : members[member].travel; }
  size_t memberCount() const { return std::max<size_t>(1, members.size()); }
};

struct FakeCharacter {
  std::map<std::string, std::vector<uint8_t>> files;
  FlatJson manifest;
  std::vector<FakeSequence> sequences;
};

// Hash of the bytes, as in manifests.
inline std::string hashText(std::span<const uint8_t> bytes) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(fnv1a(bytes)));
  return digits;
}

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

// First bytes of a sample: sequence, frame, key, rendition.
inline std::vector<uint8_t> fakeSample(uint32_t sequence, uint32_t frame, bool key, uint32_t rendition = 0,
                                       uint32_t times = 1) {
  std::vector<uint8_t> bytes((key ? 900 : 120 + frame % 50) * times, 0xee);
  std::memcpy(bytes.data(), &sequence, 4);
  std::memcpy(bytes.data() + 4, &frame, 4);
  bytes[8] = key;
  bytes[9] = uint8_t(rendition);
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
        set("/mesh/byteLength", double(mesh.bytes.size())), set("/mesh/hash", hashText(mesh.bytes));
    set("/poster/uri", std::string("poster.webp")), set("/groundY", 0.0);
    for (int i = 0; i < 3; ++i)
      set("/bounds/min/" + std::to_string(i), -1.0), set("/bounds/max/" + std::to_string(i), 2.0);
    camera();
    for (uint32_t s = 0; s < out_.sequences.size(); ++s) sequence(s);
    return std::move(out_);
  }

  // Bytes of the start file, which is added to the character's manifest.
  static std::vector<uint8_t> addStart(FakeCharacter& character, bool with_header = false) {
    const FakeSequence& q = character.sequences[0];
    const std::string at = std::string("/extensions/") + package::kExtensionName;
    const std::vector<uint8_t>& stream = character.files[q.name + ".bin"];
    const auto header =
        std::span(stream).first(size_t(*character.manifest.number(at + "/sequences/0/stream/headerLength")));
    package::StreamIndex index = package::readStreamHeader(header).take();
    const package::ChunkEntry chunk = index.chunks[0];
    const package::VideoSample key = index.renditions[0].samples[0];
    std::vector<uint8_t> start =
        package::encodeStartFile(index, std::span(stream).subspan(chunk.offset, chunk.bytes),
                                 std::span(character.files[q.videoOf(0)]).subspan(key.offset, key.bytes),
                                 header.first(with_header ? header.size() : 0), fakeMesh().decoded)
            .take();
    character.manifest.set(at + "/start/uri", std::string("character.start.bin"));
    character.manifest.set(at + "/start/byteLength", double(start.size()));
    character.manifest.set(at + "/start/hash", hashText(start));
    return start;
  }

  // `choose`: entry into `target` from a frame of `source`. Weight rows of a class: each member alone.
  using Choose = std::function<motion::Entry(uint32_t source, uint32_t frame, uint32_t target)>;
  static void addGraph(FakeCharacter& character, const Choose& choose) {
    std::vector<motion::GraphState> states;
    for (const FakeSequence& s : character.sequences) {
      motion::GraphState state{s.frames, {}};
      for (size_t m = 0; m < s.memberCount(); ++m) {
        state.weight_rows.emplace_back(s.memberCount());
        state.weight_rows.back()[m] = 1;
      }
      states.push_back(state);
    }
    std::vector<std::vector<motion::Entry>> tables;
    for (uint32_t a = 0; a < states.size(); ++a)
      for (uint32_t b = 0; b < states.size(); ++b) {
        std::vector<motion::Entry>& table = tables.emplace_back();
        if (a == b) continue;
        for (size_t row = 0; row < states[a].weight_rows.size(); ++row)
          for (uint32_t f = 0; f < states[a].frame_count; ++f) table.push_back(choose(a, f, b));
      }
    std::vector<uint8_t> bytes = motion::writeMotionGraph(states, tables);
    const std::string at = std::string("/extensions/") + package::kExtensionName + "/graph";
    character.manifest.set(at + "/uri", std::string("graph.bin"));
    character.manifest.set(at + "/byteLength", double(bytes.size()));
    character.manifest.set(at + "/hash", hashText(bytes));
    character.files["graph.bin"] = std::move(bytes);
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
    package::StreamIndex index;
    index.frame_count = q.frames;
    index.vertex_count = vertices_;
    index.face_count = faces_;
    index.layer_count = 1;
    index.member_count = uint32_t(q.memberCount());
    index.position_step_m = kStep_m;
    std::vector<std::vector<uint8_t>> chunks;
    for (uint32_t first = 0; first < q.frames; first += q.gop) {
      const uint32_t count = std::min(q.gop, q.frames - first);
      chunks.push_back(chunk(s, first, count));
      index.chunks.push_back({first, count, 0, uint32_t(chunks.back().size()), fnv1a(chunks.back())});
    }
    for (uint32_t r = 0; r < q.renditions; ++r) index.renditions.push_back(rendition(s, r));
    if (q.coarse > 0) addCoarseChunks(s, chunks, index);
    uint64_t offset = package::writeStreamHeader(index).size();
    const double header_bytes = double(offset);
    for (auto* entries : {&index.chunks, &index.coarse_chunks})
      for (package::ChunkEntry& entry : *entries) entry.offset = offset, offset += entry.bytes;
    std::vector<uint8_t> stream = package::writeStreamHeader(index);
    for (const auto& bytes : chunks) stream.insert(stream.end(), bytes.begin(), bytes.end());
    describe(s, q, double(stream.size()), header_bytes);
    set("/sequences/" + std::to_string(s) + "/stream/headerHash",
        hashText(std::span(stream).first(size_t(header_bytes))));
    out_.files[q.name + ".bin"] = std::move(stream);
  }
  void addCoarseChunks(uint32_t s, std::vector<std::vector<uint8_t>>& chunks, package::StreamIndex& index) {
    index.coarse_chunks = index.chunks;
    double bytes = 0;
    for (package::ChunkEntry& entry : index.coarse_chunks) {
      chunks.push_back(
          package::encodeChunk(framesOf(s, entry.first_frame, entry.frame_count), chunk_mesh_, {12, 12}).take());
      entry.bytes = uint32_t(chunks.back().size());
      entry.hash = fnv1a(chunks.back());
      bytes += entry.bytes;
    }
    const std::string at = "/sequences/" + std::to_string(s) + "/stream/coarse";
    set("/version", 3.0), set(at + "/renditions", double(out_.sequences[s].coarse)), set(at + "/byteLength", bytes);
  }
  package::SampleTable rendition(uint32_t s, uint32_t r) {
    const FakeSequence& q = out_.sequences[s];
    std::vector<uint8_t> video(500 + 100 * r, 0);  // offset of the first sample, as in an mp4
    package::SampleTable table;
    table.decoder_description = {uint8_t(r), uint8_t(s)};
    for (uint32_t first = 0; first < q.frames; first += q.gop) {
      table.chunk_first_sample.push_back(uint32_t(table.samples.size()));
      for (uint32_t i : decodingOrder(std::min(q.gop, q.frames - first))) {
        const std::vector<uint8_t> bytes = fakeSample(s, first + i, i == 0, r, q.heavier ? r + 1 : 1);
        table.samples.push_back({video.size(), uint32_t(bytes.size()), first + i, i == 0});
        video.insert(video.end(), bytes.begin(), bytes.end());
      }
      const uint64_t start = table.samples[table.chunk_first_sample.back()].offset;
      table.chunk_hash.push_back(fnv1a(std::span(video).subspan(start)));
    }
    table.chunk_first_sample.push_back(q.frames);
    out_.files[q.videoOf(r)] = std::move(video);
    return table;
  }
  std::vector<uint8_t> chunk(uint32_t s, uint32_t first, uint32_t count) {
    return package::encodeChunk(framesOf(s, first, count), chunk_mesh_).take();
  }
  package::ChunkFrames framesOf(uint32_t s, uint32_t first, uint32_t count) const {
    const FakeSequence& q = out_.sequences[s];
    package::ChunkFrames frames;
    frames.frame_count = count;
    frames.vertex_count = vertices_;
    frames.face_count = faces_;
    frames.layer_count = 1;
    frames.member_count = uint32_t(q.memberCount());
    for (uint32_t f = 0; f < count; ++f) {
      for (size_t m = 0; m < q.memberCount(); ++m) {
        for (uint32_t v = 0; v < vertices_; ++v) {
          const int y = int(v * 7) + (v == 1 ? kMemberTag * int(m) : 0);
          frames.positions.emplace_back(kFrameStride * int(first + f + kSequenceFrames * s), y, int(v * v));
        }
        frames.labels.insert(frames.labels.end(), faces_, 0);
        frames.root.push_back(glm::vec3(q.travel(m) * (double(first + f) / q.frames)));
      }
    }
    return frames;
  }
  void describe(uint32_t s, const FakeSequence& q, double stream_bytes, double header_bytes) {
    const std::string at = "/sequences/" + std::to_string(s);
    set(at + "/name", q.name), set(at + "/frameCount", double(q.frames)), set(at + "/fps", q.fps),
        set(at + "/loop", q.loop);
    for (int i = 0; i < 3; ++i) set(at + "/rootVelocity/" + std::to_string(i), 0.0);
    set(at + "/stream/uri", q.name + ".bin"), set(at + "/stream/byteLength", stream_bytes);
    set(at + "/stream/headerLength", header_bytes);
    for (uint32_t r = 0; r < q.renditions; ++r) describeRendition(at + "/renditions/" + std::to_string(r), q, r);
    if (!q.members.empty()) describeMembers(at, q);
  }
  void describeRendition(const std::string& r, const FakeSequence& q, uint32_t number) {
    const std::string uri = q.videoOf(number);
    set(r + "/uri", uri), set(r + "/byteLength", double(out_.files.at(uri).size())),
        set(r + "/codec", std::string("avc1.640028"));
    set(r + "/width", double(q.widthOf(number))), set(r + "/height", double(q.height));
    const double layer[4] = {0, 0, 4, 4}, strip[4] = {0, 4, 128, 4};
    for (int i = 0; i < 4; ++i) {
      for (size_t m = 0; m < q.memberCount(); ++m)
        set(r + "/layers/" + std::to_string(m) + "/" + std::to_string(i), layer[i]);
      set(r + "/barcode/rect/" + std::to_string(i), strip[i]);
    }
    set(r + "/barcode/cellSize", 4.0);
  }
  // Speed blends linearly in the weights, so that two samples suffice.
  void describeMembers(const std::string& at, const FakeSequence& q) {
    const bool is_class = q.members.size() > 1;
    for (size_t m = 0; m < q.members.size(); ++m) {
      const FakeMember& member = q.members[m];
      const std::string here = at + "/members/" + std::to_string(m);
      const std::string sample = at + "/parameterSpace/samples/" + std::to_string(m);
      set(here + "/name", q.name + std::to_string(m)), set(here + "/duration", member.duration_s);
      for (int i = 0; i < 3; ++i) set(here + "/travel/" + std::to_string(i), member.travel[i]);
      if (!is_class) continue;
      set(here + "/parameter/0", member.speed_mps), set(sample + "/at/0", member.speed_mps);
      for (size_t w = 0; w < q.members.size(); ++w) set(sample + "/weights/" + std::to_string(w), w == m ? 1.0 : 0.0);
      if (m == 0) continue;
      const std::string simplex = at + "/parameterSpace/simplices/" + std::to_string(m - 1);
      set(simplex + "/0", double(m - 1)), set(simplex + "/1", double(m)), set(simplex + "/2", double(m));
    }
    if (is_class) {
      set(at + "/parameterSpace/names/0", std::string("speed_mps"));
      set(at + "/referenceCount", 0.0);
      set(at + "/detailCorrelation", 1.0);
    }
  }

  FakeCharacter out_;
  uint32_t vertices_ = 0, faces_ = 0;
  package::ChunkMesh chunk_mesh_;
};

// Part of the range that lies within the file.
inline std::span<const uint8_t> partOf(std::span<const uint8_t> file, uint64_t offset, uint64_t bytes) {
  const uint64_t from = std::min<uint64_t>(offset, file.size());
  return file.subspan(size_t(from), size_t(std::min<uint64_t>(bytes, file.size() - from)));
}

// Updates hashes after files were changed, so that a test reaches the checks behind them. Leaves the hashes in a header
// that cannot be read.
inline void rehash(FakeCharacter& character) {
  const std::string at = std::string("/extensions/") + package::kExtensionName;
  const auto length = [&](const std::string& field) {
    return uint64_t(std::clamp(character.manifest.number(at + field).value_or(0), 0.0, 1e9));
  };
  character.manifest.set(at + "/mesh/hash",
                         hashText(partOf(character.files["mesh.bin"], 0, length("/mesh/byteLength"))));
  for (size_t s = 0; s < character.sequences.size(); ++s) {
    const std::string stream = "/sequences/" + std::to_string(s) + "/stream";
    std::vector<uint8_t>& file = character.files[character.sequences[s].name + ".bin"];
    const std::span<const uint8_t> header = partOf(file, 0, length(stream + "/headerLength"));
    if (auto read = package::readStreamHeader(header)) {
      package::StreamIndex index = read.take();
      package::SampleTable& table = index.renditions[0];
      const std::vector<uint8_t>& video_file = character.files[character.sequences[s].name + ".mp4"];
      for (uint32_t c = 0; c < index.chunks.size(); ++c) {
        package::ChunkEntry& chunk = index.chunks[c];
        chunk.hash = fnv1a(partOf(file, chunk.offset, chunk.bytes));
        const package::ByteSpan video = table.videoOf(c);
        table.chunk_hash[c] = fnv1a(partOf(video_file, video.offset, video.bytes));
      }
      const std::vector<uint8_t> again = package::writeStreamHeader(index);
      std::copy(again.begin(), again.end(), file.begin());
    }
    character.manifest.set(at + stream + "/headerHash", hashText(header));
  }
}

inline package::BarcodeStrip fakeStrip() { return {{0, 4, 128, 4}, 4}; }

// Draws nothing. Tags textures by their uploads and reads the tags of textures that are drawn together; returns the
// tags of pictures filled by the edge as barcode cells, a few polls late.
class TaggingDevice final : public gpu::Device {
 public:
  TaggingDevice() : Device(capsOfNone()) {}
  struct Drawn {
    int picture_frame = -1, geometry_frame = -1, geometry_sequence = -1, picture_width = 0;
    double x_m = 0;     // of vertex 0
    double member = 0;  // mean of the members' numbers by their weights
  };
  Drawn drawn;

  // Records that the edge has filled the texture with a picture of this frame; the texture must be one that it may
  // fill.
  void fill(gpu::TextureId id, int frame) {
    frame_of_[texture(id)->native] = texture(id)->desc.respecifiable ? frame : -1;
  }
  int polls_of_reads = 2;
  size_t openReads() const { return reads_.size(); }

 protected:
  void onUpdateTexture(const gpu::TextureRecord& texture, const gpu::Region& region, const void* pixels,
                       int stride_bytes, int) override {
    const gpu::TextureDesc& desc = texture.desc;
    if (desc.format == gpu::PixelFormat::RGBA32F) {  // two texels per vertex
      const float* texels = static_cast<const float*>(pixels);
      first_of_[texture.native] = {texels[0], texels[9]};
    }
    if (desc.format != gpu::PixelFormat::R8 || desc.width < 128 || desc.height < 8) return;
    // For an upload of a part, `pixels` points at the part; steps back to the whole picture.
    const uint8_t* whole = static_cast<const uint8_t*>(pixels) - ptrdiff_t{stride_bytes} * region.y - region.x;
    const I420View view{desc.width, desc.height, whole, nullptr, nullptr, stride_bytes, 0, 0};
    const auto frame = package::readBarcode(fakeStrip(), view);
    frame_of_[texture.native] = frame ? int(*frame) : -1;
  }
  void onDraw(const gpu::Draw& call) override {
    for (const gpu::TextureBinding& binding : call.textures) {
      const std::string sampler = binding.sampler;
      const gpu::TextureRecord& bound = *texture(binding.texture);
      if (sampler == "u_picture_rgba" && call.uniforms.size() == 1) {
        cells_of_ = frame_of_[bound.native];
      } else if (sampler == "u_picture_y" || sampler == "u_picture_rgba") {
        drawn.picture_frame = frame_of_[bound.native];
        drawn.picture_width = bound.desc.width;
      } else if (sampler == "u_positions_normals") {
        const auto& [x, y] = first_of_[bound.native];
        const int tag = int(std::lround(x / (kStep_m * kFrameStride)));
        drawn.x_m = x;
        drawn.member = (y / kStep_m - 7) / kMemberTag;
        drawn.geometry_frame = tag % kSequenceFrames;
        drawn.geometry_sequence = tag / kSequenceFrames;
      }
    }
  }
  void onBeginRead(gpu::ReadId read, const gpu::TargetRecord*, const gpu::Region&) override {
    reads_[read] = {cells_of_, 0};
  }
  bool onEndRead(gpu::ReadId read, const gpu::Region&, void* out) override {
    auto& [frame, polls] = reads_[read];
    if (out && polls++ < polls_of_reads) return false;
    for (int cell = 0; out && cell < 2 * package::kBarcodeCells; ++cell) {
      const bool white = (package::barcodeBits(uint32_t(frame)) >> (15 - cell % package::kBarcodeCells)) & 1;
      std::memset(static_cast<uint8_t*>(out) + 4 * cell, white ? 250 : 5, 4);
    }
    reads_.erase(read);
    return true;
  }

 private:
  // By GL names of the textures.
  std::map<uint32_t, int> frame_of_;
  std::map<uint32_t, std::pair<float, float>> first_of_;  // vertex 0's x, vertex 1's y
  int cells_of_ = 0;                                      // frame whose cells were drawn last
  std::map<gpu::ReadId, std::pair<int, int>> reads_;      // frame, polls so far
};

}  // namespace fourdvt::testing
