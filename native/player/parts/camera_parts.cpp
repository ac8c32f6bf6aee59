// SPDX-License-Identifier: Apache-2.0
#include "player/parts/camera_parts.h"

#include <algorithm>

namespace fourdvt {
namespace {

uint64_t nextSerial() {
  static uint64_t serial = 0;
  return ++serial;
}

glm::vec4 vec4Of(const package::Rect& r) { return {r.x, r.y, r.width, r.height}; }

}  // namespace

void SurfaceFrame::place(const package::Character& character, const package::Sequence& sequence,
                         const package::Rendition& rendition, const package::SurfaceChunk& chunk) {
  const package::Rect& area = rendition.tiles;
  const glm::vec2 size(rendition.width, rendition.height);
  const glm::vec2 scale(float(area.width) / sequence.layout_width, float(area.height) / sequence.layout_height);
  sources.clear();
  for (const package::CameraTile& tile : chunk.tiles()) {
    const glm::vec4 place = vec4Of(tile.tile) * glm::vec4(scale, scale) + glm::vec4(area.x, area.y, 0, 0);
    sources.push_back({vec4Of(tile.source), place / glm::vec4(size, size)});
  }
  look = {character.cameras, sources, nullptr, size, nextSerial()};
}

void SurfaceFrame::take(const FrameGeometry& geometry, Positions& positions) {
  const package::Surface surface = geometry.surfaces->surface(geometry.row);
  const bool as_many = positions.size() == surface.positions.size();
  positions.assign(surface.positions.begin(), surface.positions.end());
  if (as_many && std::equal(faces.begin(), faces.end(), surface.faces.begin(), surface.faces.end())) return;
  faces.assign(surface.faces.begin(), surface.faces.end());
  topology_serial = nextSerial();
}

}  // namespace fourdvt
