// SPDX-License-Identifier: Apache-2.0
// Chunks of camera streams (frames of the GOP - 1, then the chunk) of surface_fixture.h's character: accepted ones lie
// inside its pictures and its layout, have faces of existing vertices, and keep the header's limits.
#include <cmath>
#include <cstdlib>

#include "../unit/surface_fixture.h"

using namespace fourdvt;
using namespace fourdvt::package;

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

void checkTiles(const SurfaceChunk& chunk, const Character& character) {
  require(chunk.tiles().size() == character.cameras.size());
  for (size_t c = 0; c < character.cameras.size(); ++c) {
    const CameraTile& t = chunk.tiles()[c];
    if (t.empty()) {
      require(t.source.height == 0 && t.tile.width == 0 && t.tile.height == 0);
      continue;
    }
    require(t.source.height > 0 && t.tile.width > 0 && t.tile.height > 0);
    require(t.source.x + t.source.width <= character.cameras[c].width);
    require(t.source.y + t.source.height <= character.cameras[c].height);
    require(t.tile.x + t.tile.width <= character.sequences[0].layout_width);
    require(t.tile.y + t.tile.height <= character.sequences[0].layout_height);
  }
}

void checkSurface(const Surface& surface, const StreamIndex& index) {
  require(surface.positions.size() <= index.vertex_count && surface.faces.size() <= index.face_count);
  require(!surface.faces.empty());
  for (const glm::uvec3& f : surface.faces)
    require(f.x < surface.positions.size() && f.y < surface.positions.size() && f.z < surface.positions.size());
  for (const glm::vec3& p : surface.positions) require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::span<const uint8_t> bytes(data + 1, size - 1);
  static const Character character = testing::surfaceCharacter();
  StreamIndex index;
  index.frame_count = 1u + data[0] % 16;
  index.vertex_count = 200;
  index.face_count = 400;
  index.position_origin = testing::kSurfaceOrigin_m;
  index.position_step_m = testing::kSurfaceStep_m;
  index.chunks = {{0, index.frame_count, 0, uint32_t(bytes.size())}};
  auto chunk = SurfaceChunk::open(bytes, index, 0, character, character.sequences[0]);
  if (!chunk.ok()) return 0;
  checkTiles(*chunk.value(), character);
  for (uint32_t f = 0; f < index.frame_count; ++f) {
    if (!chunk.value()->decodeTo(f).ok()) {
      require(!chunk.value()->decodeTo(0).ok());
      return 0;
    }
    checkSurface(chunk.value()->surface(f), index);
    require(chunk.value()->surface(f).topology <= f);
  }
  require(chunk.value()->bytes() <= index.frame_count * 12ull * (index.vertex_count + index.face_count) + 1000);
  return 0;
}
