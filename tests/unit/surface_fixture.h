// SPDX-License-Identifier: Apache-2.0
// Surfaces and a character for chunks of camera streams: a closed round body and two cameras.
#pragma once

#include <cmath>

#include "package/surface_chunk.h"

namespace fourdvt::testing {

constexpr float kSurfaceStep_m = 0.0005f;
inline const glm::vec3 kSurfaceOrigin_m{-1, 0, -1};

// Body of `around` by `along` bands with a pole at each end, 0.6 m wide and 1.6 m high, centred on (0, 0.9, 0).
inline package::QuantisedSurface roundSurface(uint32_t around, uint32_t along, float time_s) {
  package::QuantisedSurface out;
  const auto add = [&](float polar, float azimuth) {
    const float radius = 0.3f * std::sin(polar) * (1 + 0.15f * std::sin(3 * azimuth + 4 * time_s));
    const glm::vec3 p(radius * std::cos(azimuth), 0.9f - 0.8f * std::cos(polar), radius * std::sin(azimuth));
    out.positions.emplace_back(glm::round((p - kSurfaceOrigin_m) / kSurfaceStep_m));
  };
  add(0, 0);
  for (uint32_t j = 1; j < along; ++j)
    for (uint32_t i = 0; i < around; ++i) add(3.1415927f * j / along, 6.2831853f * i / around);
  add(3.1415927f, 0);
  const uint32_t top = static_cast<uint32_t>(out.positions.size()) - 1;
  const auto at = [&](uint32_t j, uint32_t i) { return 1 + (j - 1) * around + i % around; };
  for (uint32_t i = 0; i < around; ++i) {
    out.faces.emplace_back(0, at(1, i), at(1, i + 1));
    for (uint32_t j = 1; j + 1 < along; ++j) {
      out.faces.emplace_back(at(j, i), at(j + 1, i), at(j + 1, i + 1));
      out.faces.emplace_back(at(j, i), at(j + 1, i + 1), at(j, i + 1));
    }
    out.faces.emplace_back(at(along - 1, i), top, at(along - 1, i + 1));
  }
  return out;
}

// Four frames, with a topology each or a common one.
inline std::vector<package::QuantisedSurface> surfacesOfAGop(bool constant_topology, float start_s = 0) {
  std::vector<package::QuantisedSurface> out;
  for (uint32_t f = 0; f < 4; ++f)
    out.push_back(roundSurface(constant_topology ? 12 : 10 + f, constant_topology ? 10 : 12 - f, start_s + 0.04f * f));
  return out;
}

// Two cameras of 100 × 120 pixels; one sequence without files, with a layout of 64 × 48 texels.
inline package::Character surfaceCharacter() {
  package::Character c;
  c.name = "body";
  c.version = package::kCameraFormatVersion;
  c.appearance = package::AppearanceKind::Cameras;
  for (int k = 0; k < 2; ++k) {
    OrbitView view;
    view.azimuth_deg = 90 * k;
    c.cameras.push_back(cameraFromOrbit(view, 100, 120));
    c.cameras.back().name = "cam0" + std::to_string(k);
  }
  c.bounds = {{-0.4f, 0.1f, -0.4f}, {0.4f, 1.7f, 0.4f}};
  package::Sequence s;
  s.name = "turn";
  s.frame_count = 8;
  s.fps = 25;
  s.loop = true;
  s.layout_width = 64;
  s.layout_height = 48;
  c.sequences = {s};
  return c;
}

// Tiles of the cameras in GOP 0 or 1; in GOP 1 the second camera has none.
inline std::vector<package::CameraTile> tilesOfAGop(uint32_t gop) {
  if (gop == 0) return {{{30, 20, 40, 80}, {0, 0, 24, 48}}, {{32, 22, 40, 80}, {24, 0, 20, 40}}};
  return {{{28, 18, 44, 88}, {8, 4, 22, 44}}, {}};
}

}  // namespace fourdvt::testing
