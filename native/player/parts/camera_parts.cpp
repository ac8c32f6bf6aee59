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

class CameraPartsOfPlayer final : public CameraParts {
 public:
  Result<std::unique_ptr<package::SurfaceChunk>> open(std::span<const uint8_t> bytes, const package::StreamIndex& index,
                                                      uint32_t chunk, const package::Character& character,
                                                      const package::Sequence& sequence) const override {
    return package::SurfaceChunk::open(bytes, index, chunk, character, sequence);
  }

  Result<render::CharacterModel> makeModel(gpu::Device& device, const package::Character& character) const override {
    return render::CharacterModel::createForSurfaces(device, character);
  }

  void placePictures(const package::Character& character, const package::Sequence& sequence,
                     const package::Rendition& rendition, const package::SurfaceChunk& chunk,
                     SurfaceFrame& frame) const override {
    const package::Rect& area = rendition.tiles;
    const glm::vec2 size(rendition.width, rendition.height);
    const glm::vec2 scale(float(area.width) / sequence.layout_width, float(area.height) / sequence.layout_height);
    frame.sources.clear();
    for (const package::CameraTile& tile : chunk.tiles()) {
      const glm::vec4 place = vec4Of(tile.tile) * glm::vec4(scale, scale) + glm::vec4(area.x, area.y, 0, 0);
      frame.sources.push_back({vec4Of(tile.source), place / glm::vec4(size, size)});
    }
    frame.look = {character.cameras, frame.sources, nullptr, size, nextSerial()};
  }

  void takeSurface(const FrameGeometry& geometry, Positions& positions, SurfaceFrame& frame) const override {
    const package::Surface surface = geometry.surfaces->surface(geometry.row);
    const bool as_many = positions.size() == surface.positions.size();
    positions.assign(surface.positions.begin(), surface.positions.end());
    if (as_many && std::equal(frame.faces.begin(), frame.faces.end(), surface.faces.begin(), surface.faces.end()))
      return;
    frame.faces.assign(surface.faces.begin(), surface.faces.end());
    frame.topology_serial = nextSerial();
  }

  void setTopology(gpu::Device& device, const SurfaceFrame& frame, size_t vertices,
                   render::CharacterModel& model) const override {
    // It keeps to the manifest's counts: the reader of surfaces has checked that.
    (void)model.setTopology(device, frame.faces, static_cast<uint32_t>(vertices));
  }
};

}  // namespace

const CameraParts& cameraParts() {
  static const CameraPartsOfPlayer parts;
  return parts;
}

}  // namespace fourdvt
