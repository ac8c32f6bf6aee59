// SPDX-License-Identifier: Apache-2.0
// A live stream in memory: the manifest of surface_fixture.h's body, and frames whose surface, sample and capture time
// follow from their number.
#pragma once

#include "package/live_stream.h"
#include "surface_fixture.h"

namespace fourdvt::testing {

inline FlatJson liveManifest() {
  const package::Character body = surfaceCharacter();
  FlatJson out;
  const auto set = [&](const std::string& field, FlatJson::Value value) {
    out.set(std::string("/extensions/") + package::kExtensionName + field, std::move(value));
  };
  const auto setAll = [&](const std::string& field, const std::vector<double>& values) {
    for (size_t i = 0; i < values.size(); ++i) set(field + "/" + std::to_string(i), values[i]);
  };
  out.set("/asset/version", std::string("2.0"));
  set("/version", 4.0), set("/appearance", std::string("cameras")), set("/name", body.name);
  set("/vertexCount", 200.0), set("/faceCount", 400.0), set("/groundY", 0.25), set("/lengthScale", 1.0);
  set("/method/name", std::string("fvvr"));
  setAll("/bounds/min", {-0.4, 0.1, -0.4}), setAll("/bounds/max", {0.4, 1.7, 0.4});
  for (size_t k = 0; k < body.cameras.size(); ++k) {
    const PinholeCamera& camera = body.cameras[k];
    const std::string at = "/cameras/" + std::to_string(k);
    set(at + "/name", camera.name), set(at + "/width", double(camera.width)),
        set(at + "/height", double(camera.height));
    set(at + "/fx", camera.fx), set(at + "/fy", camera.fy), set(at + "/cx", camera.cx), set(at + "/cy", camera.cy);
    for (int i = 0; i < 16; ++i) set(at + "/camFromWorld/" + std::to_string(i), camera.cam_from_world[i / 4][i % 4]);
  }
  set("/live/session", std::string("00c0ffee12345678")), set("/live/fps", 25.0);
  setAll("/live/layout", {64, 48}), set("/live/codec", std::string("avc1.42C01F"));
  set("/live/width", 192.0), set("/live/height", 64.0), setAll("/live/tiles", {0, 16, 64, 48});
  setAll("/live/barcode/rect", {0, 4, 128, 4}), set("/live/barcode/cellSize", 4.0);
  setAll("/live/origin", {kSurfaceOrigin_m.x, kSurfaceOrigin_m.y, kSurfaceOrigin_m.z});
  set("/live/step", double(kSurfaceStep_m));
  return out;
}

// Number of bands round the body, by which a surface identifies its frame.
inline uint32_t bandsOf(uint32_t number) { return 6 + number % 7; }
inline uint32_t facesOf(uint32_t number) { return 2 * bandsOf(number) * 7; }

inline int64_t capturedUsOf(uint32_t number) { return 1'700'000'000'000'000 + int64_t{40000} * number; }

inline std::vector<uint8_t> liveChunk(uint32_t number) {
  const std::vector<package::QuantisedSurface> surface{roundSurface(bandsOf(number), 8, 0)};
  return package::encodeSurfaceChunk(tilesOfAGop(0), surface).take().bytes;
}

// Message of a frame; its sample is the number in four bytes.
inline std::vector<uint8_t> liveMessage(uint32_t number, bool key, const std::vector<uint8_t>& chunk) {
  const uint8_t sample[4] = {uint8_t(number >> 24), uint8_t(number >> 16), uint8_t(number >> 8), uint8_t(number)};
  return package::writeLiveFrame({number, key, capturedUsOf(number), chunk, sample});
}
inline std::vector<uint8_t> liveMessage(uint32_t number, bool key) {
  return liveMessage(number, key, liveChunk(number));
}

}  // namespace fourdvt::testing
