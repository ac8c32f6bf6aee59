// SPDX-License-Identifier: Apache-2.0
// Cost of a baked character's streams besides the video, part by part: kbit/s, bytes of labels per frame, and processor
// time to decode all parts as the player does. A class has labels and positions of every member.
// Usage: bench_label_stream CHARACTER_FOLDER [RUNS]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "or_stop.h"
#include "package/character.h"
#include "package/chunk_counts.h"
#include "package/chunk_mesh.h"
#include "package/stream_file.h"
#include "platform/files.h"

using namespace fourdvt;
using fourdvt::testing::orStop;

namespace {

// Processor time, ms: unaffected by other processes.
double now_ms() { return 1e3 * double(std::clock()) / CLOCKS_PER_SEC; }

struct Cost {
  uint64_t positions = 0, labels = 0, offsets = 0, alignment = 0, root = 0;  // bytes, with their lengths
  uint64_t changed = 0,
           compared = 0;  // labels that differ from the previous frame of their chunk, of all that have one
  double decode_ms = 0, slowest_chunk_ms = 0;
};

void countChanges(const package::ChunkFrames& frames, Cost& cost) {
  const size_t per_frame = size_t(frames.member_count) * frames.layer_count * frames.face_count;
  for (size_t i = per_frame; i < frames.labels.size(); ++i)
    cost.changed += frames.labels[i] != frames.labels[i - per_frame];
  cost.compared += frames.labels.size() - per_frame;
}

// Counts bytes by part; the root motion's are the remainder.
void countBytes(std::span<const uint8_t> chunk, const package::StreamIndex& index, Cost& cost) {
  ByteReader lengths(chunk);
  uint64_t root = chunk.size();
  for (uint32_t part = 0; part < package::partCount(index); ++part) {
    const uint64_t bytes = sizeof(uint32_t) + lengths.u32();
    root -= bytes;
    if (part < 2 * index.member_count)
      (part % 2 == 0 ? cost.positions : cost.labels) += bytes;
    else
      (part < 2 * index.member_count + index.reference_count ? cost.offsets : cost.alignment) += bytes;
  }
  cost.root += root;
}

Cost measure(const std::string& path, const package::Sequence& sequence, const package::ChunkMesh& mesh, int runs) {
  Cost cost;
  const std::vector<uint8_t> header = orStop(platform::readFileRange(path, 0, sequence.stream_header_bytes));
  const package::StreamIndex index = orStop(package::readStreamHeader(header));
  for (uint32_t c = 0; c < index.chunks.size(); ++c) {
    const auto bytes = orStop(platform::readFileRange(path, index.chunks[c].offset, index.chunks[c].bytes));
    countBytes(bytes, index, cost);
    double best_ms = 1e9;
    for (int run = 0; run < runs; ++run) {
      const double start_ms = now_ms();
      const package::ChunkFrames frames = orStop(package::decodeChunk(bytes, index, c, mesh));
      best_ms = std::min(best_ms, now_ms() - start_ms);
      if (run == 0) countChanges(frames, cost);
    }
    cost.decode_ms += best_ms;
    cost.slowest_chunk_ms = std::max(cost.slowest_chunk_ms, best_ms);
  }
  return cost;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: bench_label_stream CHARACTER_FOLDER [RUNS]\n"), 2;
  const std::string folder = std::string(argv[1]) + "/";
  const int runs = argc > 2 ? std::max(1, std::atoi(argv[2])) : 5;
  const package::Character c = orStop(package::readManifest(orStop(platform::readJsonFlat(folder + "character.gltf"))));
  const package::BaseMesh base = orStop(
      package::decodeBaseMesh(orStop(platform::readFileRange(folder + c.mesh_uri, c.mesh_offset, c.mesh_bytes))));
  const double start_ms = now_ms();
  const package::ChunkMesh mesh = package::makeChunkMesh(base);
  std::printf("%u vertices, %u faces, %d layers; adjacency %.1f ms\n", c.vertex_count, c.face_count, c.layer_count,
              now_ms() - start_ms);
  std::printf("%-12s %6s %9s | kbit/s %9s %9s %9s %9s %9s | %10s %12s %12s\n", "sequence", "frames", "labels B",
              "labels", "positions", "offsets", "alignment", "root", "changed %", "cpu ms/frame", "cpu ms/chunk");
  for (const package::Sequence& s : c.sequences) {
    const Cost cost = measure(folder + s.stream_uri, s, mesh, runs);
    const auto kbps = [&](uint64_t bytes) { return double(bytes) / s.frame_count * s.fps * 8e-3; };
    std::printf("%-12s %6u %9.0f |        %9.1f %9.1f %9.1f %9.1f %9.1f | %10.2f %12.2f %12.1f\n", s.name.c_str(),
                s.frame_count, double(cost.labels) / s.frame_count, kbps(cost.labels), kbps(cost.positions),
                kbps(cost.offsets), kbps(cost.alignment), kbps(cost.root),
                cost.compared ? 100.0 * double(cost.changed) / double(cost.compared) : 0.0,
                cost.decode_ms / s.frame_count, cost.slowest_chunk_ms);
  }
}
