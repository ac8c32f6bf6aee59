// SPDX-License-Identifier: Apache-2.0
// What a frame of a baked class costs on one core, in the build that a page runs or natively: decoding its geometry,
// and blending its mesh at several weights, linear and hybrid. Goal: the hybrid blend in at most 0.5 ms in wasm.
//   NODE_PATH=/usr/share/nodejs ninja -C build/wasm bench_class_frame &&
//     node build/wasm/tests/bench/wasm/bench_class_frame.js build/character
//   build/release/tests/bench/bench_class_frame build/character
// How far either blend is from the non-linear one: bench_mesh_blend.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/blend_cost.h"
#include "or_stop.h"
#include "package/base_mesh.h"
#include "package/coding/chunk_decoder.h"

using namespace fourdvt;
using fourdvt::testing::orStop;

namespace {

[[noreturn]] void stop(const std::string& why) {
  std::fprintf(stderr, "bench_class_frame: %s\n", why.c_str());
  std::exit(1);
}

std::vector<uint8_t> read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) stop(path + ": cannot be read; name the folder of a baked character");
  return {std::istreambuf_iterator<char>(file), {}};
}

package::Character readCharacter(const std::string& folder) {
  const auto json = nlohmann::json::parse(read(folder + "/character.gltf"), nullptr, false);
  if (json.is_discarded()) stop(folder + "/character.gltf: not valid JSON; bake the character again");
  const auto values = json.flatten();
  FlatJson flat;
  for (const auto& [pointer, value] : values.items()) {
    if (value.is_number()) flat.set(pointer, value.get<double>());
    if (value.is_string()) flat.set(pointer, value.get<std::string>());
    if (value.is_boolean()) flat.set(pointer, value.get<bool>());
  }
  return orStop(package::readManifest(flat));
}

struct Stream {
  std::vector<uint8_t> bytes;
  package::StreamIndex index;
  std::span<const uint8_t> chunk(uint32_t i) const {
    return std::span(bytes).subspan(index.chunks[i].offset, index.chunks[i].bytes);
  }
};

struct DecodingCost {
  double first_ms = 0, other_ms = 0;  // of a GOP: means
};

// contents: the first GOP's.
DecodingCost decodeOnce(const Stream& stream, const package::ChunkMesh& mesh, package::ChunkFrames& contents) {
  DecodingCost sum;
  uint32_t others = 0;
  const auto chunks = static_cast<uint32_t>(stream.index.chunks.size());
  for (uint32_t i = 0; i < chunks; ++i) {
    double start = bench::now_ms();
    auto decoder = orStop(package::ChunkDecoder::open(stream.chunk(i), stream.index, i, mesh));
    for (uint32_t frame = 0; frame < stream.index.chunks[i].frame_count; ++frame) {
      if (const Status decoded = decoder->decodeTo(frame); !decoded.ok()) stop(decoded.error().message);
      const double end = bench::now_ms();
      (frame ? sum.other_ms : sum.first_ms) += end - start;
      others += frame > 0;
      start = end;
    }
    if (i == 0) contents = decoder->take();
  }
  return {sum.first_ms / chunks, others ? sum.other_ms / others : 0};
}

package::ChunkFrames printDecoding(const Stream& stream, const package::ChunkMesh& mesh) {
  constexpr int kRuns = 4;
  package::ChunkFrames contents;
  DecodingCost least{HUGE_VAL, HUGE_VAL};
  for (int run = 0; run < kRuns; ++run) {
    const DecodingCost cost = decodeOnce(stream, mesh, contents);
    least = {std::min(least.first_ms, cost.first_ms), std::min(least.other_ms, cost.other_ms)};
  }
  std::printf("decoding: %.1f ms the first frame of a GOP, %.1f ms another; %zu GOPs\n", least.first_ms, least.other_ms,
              stream.index.chunks.size());
  return contents;
}

float furthest_mm(const Positions& a, const Positions& b) {
  float most = 0;
  for (size_t v = 0; v < a.size(); ++v) most = std::max(most, glm::distance(a[v], b[v]));
  return 1e3f * most;
}

void printBlends(const package::Sequence& sequence, const package::StreamIndex& index,
                 const package::ChunkFrames& frames) {
  constexpr int kWeights = 5;
  const motion::Range range = motion::parameterRange(sequence, 0);
  std::vector<double> at;
  for (size_t p = 0; p < sequence.space.names.size(); ++p) {
    const motion::Range other = motion::parameterRange(sequence, p);
    at.push_back((other.min + other.max) / 2);
  }
  const uint32_t row = frames.frame_count / 2;
  for (int i = 0; i < kWeights; ++i) {
    at[0] = range.min + (range.max - range.min) * i / (kWeights - 1);
    const motion::BlendWeights hybrid = motion::weightsAt(sequence, at);
    const motion::BlendWeights linear{hybrid.members, {}};
    const auto used = std::count_if(hybrid.offsets.begin(), hybrid.offsets.end(), [](float x) { return x != 0; });
    Positions a, b;
    motion::blendFrame(frames, row, index, linear, a);
    motion::blendFrame(frames, row, index, hybrid, b);
    const double linear_ms = bench::blendCost_ms(frames, row, index, linear);
    const double hybrid_ms = bench::blendCost_ms(frames, row, index, hybrid);
    std::printf("%s %.3f: linear %.4f ms, hybrid %.4f ms (%td corrections, up to %.2f mm): x %.2f\n",
                sequence.space.names[0].c_str(), at[0], linear_ms, hybrid_ms, used, furthest_mm(a, b),
                hybrid_ms / linear_ms);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) stop("usage: bench_class_frame CHARACTER_FOLDER");
  const std::string folder = std::string(argv[1]) + "/";
  const package::Character character = readCharacter(argv[1]);
  const std::vector<uint8_t> mesh_file = read(folder + character.mesh_uri);
  const auto mesh_bytes = std::span(mesh_file).subspan(character.mesh_offset, character.mesh_bytes);
  const package::ChunkMesh mesh = package::makeChunkMesh(orStop(package::decodeBaseMesh(mesh_bytes)));
  int classes = 0;
  for (const package::Sequence& sequence : character.sequences) {
    if (!sequence.isClass()) continue;
    Stream stream{read(folder + sequence.stream_uri), {}};
    stream.index = orStop(package::readStreamHeader(std::span(stream.bytes).first(sequence.stream_header_bytes)));
    std::printf("%s: %zu members, %u vertices, %u faces, %u corrections, %u frames\n", sequence.name.c_str(),
                sequence.members.size(), stream.index.vertex_count, stream.index.face_count,
                stream.index.reference_count, sequence.frame_count);
    printBlends(sequence, stream.index, printDecoding(stream, mesh));
    ++classes;
  }
  if (!classes) stop(folder + ": has no class; bake a capture with \"classes\"");
}
