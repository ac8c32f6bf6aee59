// SPDX-License-Identifier: Apache-2.0
// One frame of a baked character as plain CPU data, read from its files.
#pragma once

#include <string>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"
#include "base/result.h"
#include "base/video.h"
#include "package/base_mesh.h"
#include "package/character.h"
#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::measure {

struct CharacterFrame {
  MeshTopology topology;
  Positions positions;                       // metres
  std::vector<std::vector<uint8_t>> labels;  // [layer][face]
  std::vector<Image> layers;                 // RGB, decoded, each of its own size
};

// Reads the last rendition. `folder`: that of character.gltf. Errors: those of the files.
Result<package::Character> readCharacter(const std::string& folder);
Result<CharacterFrame> readCharacterFrame(const std::string& folder, const std::string& sequence, uint32_t frame,
                                          const OpenVideo& open_video);
// Labels of `count` frames from `first`: [frame][layer][face].
Result<std::vector<std::vector<std::vector<uint8_t>>>> readCharacterLabels(const std::string& folder,
                                                                           const std::string& sequence, uint32_t first,
                                                                           uint32_t count);

// Stream of a sequence or class, read as the player reads it.
struct CharacterStream {
  package::Character character;
  const package::Sequence* sequence = nullptr;  // in `character`
  std::string path;
  package::StreamIndex index;
  package::BaseMesh mesh;
  package::ChunkMesh chunk_mesh;
};
Status openCharacterStream(const std::string& folder, const std::string& sequence, CharacterStream& out);
Result<package::ChunkFrames> readCharacterChunk(const CharacterStream& stream, uint32_t chunk);

}  // namespace fourdvt::measure
