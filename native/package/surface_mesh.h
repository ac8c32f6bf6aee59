// SPDX-License-Identifier: Apache-2.0
// Mesh of a run: Draco edgebreaker with one POSITION attribute of 32-bit integers, lossless. Internal to package/.
#pragma once

#include <optional>

#include "package/surface_chunk.h"

namespace fourdvt::package {

// Nullopt for any other bytes, for more vertices or faces than given, or a |q| above 2^24.
std::optional<QuantisedSurface> decodeSurfaceMesh(std::span<const uint8_t> bytes, uint32_t max_vertices,
                                                  uint32_t max_faces);

struct EncodedSurfaceMesh {
  std::vector<uint8_t> bytes;
  QuantisedSurface decoded;  // result of decodeSurfaceMesh
};

// Native only. Errors: Internal, also if Draco alters the surface.
Result<EncodedSurfaceMesh> encodeSurfaceMesh(const QuantisedSurface& surface);
// Source vertex of every decoded vertex. Native only. Errors: Internal.
Result<std::vector<uint32_t>> sourceVertices(const QuantisedSurface& surface, const QuantisedSurface& decoded);

}  // namespace fourdvt::package
