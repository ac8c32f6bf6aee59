// SPDX-License-Identifier: Apache-2.0
// A small character for tests of the manifest, and its manifest as passed to the reader.
#pragma once

#include <nlohmann/json.hpp>

#include "package/writer.h"

namespace fourdvt::testing {

using namespace fourdvt::package;

inline const std::string kAt = std::string("/extensions/") + kExtensionName;

inline FlatJson flatten(const nlohmann::json& value) {
  FlatJson flat;
  const nlohmann::json flattened = value.flatten();
  for (const auto& [pointer, leaf] : flattened.items()) {
    if (leaf.is_number()) flat.set(pointer, leaf.get<double>());
    if (leaf.is_string()) flat.set(pointer, leaf.get<std::string>());
    if (leaf.is_boolean()) flat.set(pointer, leaf.get<bool>());
  }
  return flat;
}

inline EncodedBaseMesh smallMesh() {
  MeshTopology t;
  t.vertex_count = 4;
  t.uvs = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  t.face_vertices = {{0, 2, 1}, {1, 2, 3}};
  t.face_uvs = t.face_vertices;
  return encodeBaseMesh(t, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5f}}).take();
}

inline Character smallCharacter(const EncodedBaseMesh& mesh) {
  Character c;
  c.name = "tiny";
  c.layer_count = 2;
  c.vertex_count = mesh.decoded.topology.vertex_count;
  c.face_count = mesh.decoded.topology.faceCount();
  for (int k = 0; k < 3; ++k) {
    OrbitView view;
    view.azimuth_deg = 37 * k;
    view.elevation_deg = 12;
    PinholeCamera camera = cameraFromOrbit(view, 720, 960);
    camera.name = "cam0" + std::to_string(k);
    camera.cx += 3.25;
    c.cameras.push_back(camera);
  }
  c.bounds = {{-1, 0, -1}, {1, 2.125f, 1}};
  c.mesh_uri = "mesh.bin";
  c.mesh_bytes = mesh.bytes.size();
  c.mesh_hash = 0xfedcba9876543210;
  c.poster_uri = "poster.webp";
  Sequence s;
  s.name = "walk";
  s.frame_count = 28;
  s.fps = 25;
  s.loop = true;
  s.root_velocity_mps = {0, 0, 1.2265};
  s.members = {{"walk", {}, 1.12, {0, 1.375, 0.25}}};
  s.stream_uri = "walk.bin";
  s.stream_bytes = 5000000000ull;  // above 32 bits
  s.stream_header_bytes = 900;
  s.stream_header_hash = 0x12;
  s.renditions = {{"walk.mp4", 123456, "avc1.640028", 1536, 1056, {{0, 0, 1024, 1024}, {1024, 0, 512, 512}}, {}}};
  s.renditions[0].barcode.rect = {0, 1032, 512, 16};
  c.sequences = {s};
  return c;
}

}  // namespace fourdvt::testing
