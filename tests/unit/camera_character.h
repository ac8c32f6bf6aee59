// SPDX-License-Identifier: Apache-2.0
// A tiny character from cameras in memory: that of surface_fixture.h with its stream, and samples without pictures,
// built like the layered characters of player_fixture.h. In GOP 0 every frame has its own topology, in GOP 1 all share
// one.
#pragma once

#include "player_fixture.h"
#include "surface_fixture.h"

namespace fourdvt::testing {

inline FakeCharacter fakeCameraCharacter() {
  const package::Character body = surfaceCharacter();
  const package::Sequence& sequence = body.sequences[0];
  FakeCharacter out;
  out.sequences = {{sequence.name, sequence.frame_count, 4, sequence.fps, sequence.loop, 192, 64, {}}};
  package::StreamIndex index;
  index.frame_count = sequence.frame_count;
  index.position_origin = kSurfaceOrigin_m;
  index.position_step_m = kSurfaceStep_m;
  std::vector<std::vector<uint8_t>> chunks;
  std::vector<uint8_t> video(500, 0);  // offset of the first sample, as in an mp4
  package::SampleTable& table = index.renditions.emplace_back();
  table.decoder_description = {0, 0};
  for (uint32_t g = 0; g < 2; ++g) {
    package::EncodedSurfaces surfaces =
        package::encodeSurfaceChunk(tilesOfAGop(g), surfacesOfAGop(g == 1, 0.16f * g)).take();
    index.vertex_count = std::max(index.vertex_count, surfaces.vertex_count);
    index.face_count = std::max(index.face_count, surfaces.face_count);
    index.chunks.push_back({4 * g, 4, 0, uint32_t(surfaces.bytes.size()), fnv1a(surfaces.bytes)});
    chunks.push_back(std::move(surfaces.bytes));
    const size_t start = video.size();
    table.chunk_first_sample.push_back(uint32_t(table.samples.size()));
    for (uint32_t i : decodingOrder(4)) {
      const std::vector<uint8_t> bytes = fakeSample(0, 4 * g + i, i == 0);
      table.samples.push_back({video.size(), uint32_t(bytes.size()), 4 * g + i, i == 0});
      video.insert(video.end(), bytes.begin(), bytes.end());
    }
    table.chunk_hash.push_back(fnv1a(std::span(video).subspan(start)));
  }
  table.chunk_first_sample.push_back(sequence.frame_count);
  const size_t header_bytes = package::writeStreamHeader(index).size();
  uint64_t offset = header_bytes;
  for (package::ChunkEntry& entry : index.chunks) entry.offset = offset, offset += entry.bytes;
  std::vector<uint8_t> stream = package::writeStreamHeader(index);
  for (const auto& bytes : chunks) stream.insert(stream.end(), bytes.begin(), bytes.end());

  const auto set = [&](const std::string& field, FlatJson::Value value) {
    out.manifest.set(std::string("/extensions/") + package::kExtensionName + field, std::move(value));
  };
  const auto setRect = [&](const std::string& field, const package::Rect& r) {
    const int sides[4] = {r.x, r.y, r.width, r.height};
    for (int i = 0; i < 4; ++i) set(field + "/" + std::to_string(i), double(sides[i]));
  };
  out.manifest.set("/asset/version", std::string("2.0"));
  set("/version", double(body.version)), set("/appearance", std::string("cameras")), set("/name", body.name);
  set("/vertexCount", double(index.vertex_count)), set("/faceCount", double(index.face_count));
  set("/mesh/uri", std::string("mesh.bin")), set("/mesh/byteOffset", 0.0), set("/mesh/byteLength", 1.0);
  set("/mesh/hash", hashText({}));  // never fetched by the player
  set("/poster/uri", std::string("poster.webp")), set("/groundY", body.ground_y_m);
  for (int i = 0; i < 3; ++i) {
    set("/bounds/min/" + std::to_string(i), double(body.bounds.min[i]));
    set("/bounds/max/" + std::to_string(i), double(body.bounds.max[i]));
  }
  for (size_t k = 0; k < body.cameras.size(); ++k) {
    const PinholeCamera& camera = body.cameras[k];
    const std::string at = "/cameras/" + std::to_string(k);
    set(at + "/name", camera.name), set(at + "/width", double(camera.width)),
        set(at + "/height", double(camera.height));
    set(at + "/fx", camera.fx), set(at + "/fy", camera.fy), set(at + "/cx", camera.cx), set(at + "/cy", camera.cy);
    for (int i = 0; i < 16; ++i) set(at + "/camFromWorld/" + std::to_string(i), camera.cam_from_world[i / 4][i % 4]);
  }
  const std::string at = "/sequences/0", rendition = at + "/renditions/0";
  set(at + "/name", sequence.name), set(at + "/frameCount", double(sequence.frame_count));
  set(at + "/fps", sequence.fps), set(at + "/loop", sequence.loop);
  for (int i = 0; i < 3; ++i) set(at + "/rootVelocity/" + std::to_string(i), 0.0);
  set(at + "/layout/0", double(sequence.layout_width)), set(at + "/layout/1", double(sequence.layout_height));
  set(at + "/stream/uri", sequence.name + ".bin"), set(at + "/stream/byteLength", double(stream.size()));
  set(at + "/stream/headerLength", double(header_bytes));
  set(at + "/stream/headerHash", hashText(std::span(stream).first(header_bytes)));
  set(rendition + "/uri", sequence.name + ".mp4"), set(rendition + "/byteLength", double(video.size()));
  set(rendition + "/codec", std::string("avc1.640028"));
  set(rendition + "/width", 192.0), set(rendition + "/height", 64.0);
  setRect(rendition + "/tiles", {0, 16, 64, 48});
  setRect(rendition + "/barcode/rect", {0, 4, 128, 4});
  set(rendition + "/barcode/cellSize", 4.0);
  out.files[sequence.name + ".bin"] = std::move(stream);
  out.files[sequence.name + ".mp4"] = std::move(video);
  return out;
}

}  // namespace fourdvt::testing
