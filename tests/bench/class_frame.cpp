// SPDX-License-Identifier: Apache-2.0
// Cost per frame of a baked character on one core, in the page's wasm build or natively: decoding the geometry of every
// motion, and blending the mesh of a class at several weights, linear and hybrid. Goal: a hybrid blend takes at most
// 0.5 ms in wasm.
//   NODE_PATH=/usr/share/nodejs ninja -C build/wasm bench_class_frame &&
//     node build/wasm/tests/bench/wasm/bench_class_frame.js build/character
//   build/release/tests/bench/bench_class_frame build/character
// Errors of both blends against the non-linear one: bench_mesh_blend.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "bench/blend_cost.h"
#include "or_stop.h"
#include "package/base_mesh.h"
#include "package/chunk_decoder.h"

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

// Milliseconds: of opening a GOP's decoder, of each row, and of each part of a row, the smallest unit that a page
// decodes in one turn.
struct DecodingCost {
  std::vector<double> open, row, part;
};

DecodingCost decodeOnce(const Stream& stream, const package::ChunkMesh& mesh, package::ChunkFrames& contents) {
  DecodingCost cost;
  for (uint32_t i = 0; i < stream.index.chunks.size(); ++i) {
    double start = bench::now_ms();
    const auto passed_ms = [&] {
      const double before = std::exchange(start, bench::now_ms());
      return start - before;
    };
    auto decoder = orStop(package::ChunkDecoder::open(stream.chunk(i), stream.index, i, mesh));
    cost.open.push_back(passed_ms());
    for (uint32_t row = 0; row < stream.index.chunks[i].frame_count; ++row) {
      double& row_ms = cost.row.emplace_back();
      while (decoder->decodedCount() == row) {
        if (const Status decoded = decoder->step(); !decoded.ok()) stop(decoded.error().message);
        row_ms += cost.part.emplace_back(passed_ms());
      }
    }
    if (i == 0) contents = decoder->take();
  }
  return cost;
}

// Uses the minimum of several runs of each, since other processes only add time.
package::ChunkFrames printDecoding(const Stream& stream, const package::ChunkMesh& mesh) {
  constexpr int kRuns = 4;
  package::ChunkFrames contents;
  DecodingCost least = decodeOnce(stream, mesh, contents);
  for (int run = 1; run < kRuns; ++run) {
    const DecodingCost cost = decodeOnce(stream, mesh, contents);
    for (const auto list : {&DecodingCost::open, &DecodingCost::row, &DecodingCost::part})
      for (size_t i = 0; i < (cost.*list).size(); ++i) (least.*list)[i] = std::min((least.*list)[i], (cost.*list)[i]);
  }
  const auto at = [](std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
  };
  std::printf(
      "decoding: a row %.2f ms (median), %.2f ms (p95); its parts %.2f ms, %.2f ms; opening one of %zu GOPs %.2f ms\n",
      at(least.row, 0.5), at(least.row, 0.95), at(least.part, 0.5), at(least.part, 0.95), least.open.size(),
      at(least.open, 0.5));
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
    Stream stream{read(folder + sequence.stream_uri), {}};
    stream.index = orStop(package::readStreamHeader(std::span(stream.bytes).first(sequence.stream_header_bytes)));
    std::printf("%s: %zu members, %u vertices, %u faces, %u corrections, %u frames\n", sequence.name.c_str(),
                sequence.members.size(), stream.index.vertex_count, stream.index.face_count,
                stream.index.reference_count, sequence.frame_count);
    const package::ChunkFrames frames = printDecoding(stream, mesh);
    if (!sequence.isClass()) continue;
    printBlends(sequence, stream.index, frames);
    ++classes;
  }
  if (!classes) stop(folder + ": has no class; bake a capture with \"classes\"");
}
