// SPDX-License-Identifier: Apache-2.0
// One frame of a baked character as plain data: what the player keeps on the GPU. Reads its files; does NOT draw.
#pragma once

#include <string>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"
#include "base/result.h"
#include "base/video.h"
#include "package/character.h"

namespace fourdvt::evaluate {

struct CharacterFrame {
  MeshTopology topology;
  Positions positions;                       // metres
  std::vector<std::vector<uint8_t>> labels;  // [layer][face]
  std::vector<Image> layers;                 // RGB, decoded, of their own sizes
};

// `folder`: of character.gltf. The last rendition. Errors: those of the files.
Result<package::Character> readCharacter(const std::string& folder);
Result<CharacterFrame> readCharacterFrame(const std::string& folder, const std::string& sequence, uint32_t frame,
                                          const OpenVideo& open_video);
// Labels of `count` frames from `first`: [frame][layer][face].
Result<std::vector<std::vector<std::vector<uint8_t>>>> readCharacterLabels(const std::string& folder,
                                                                           const std::string& sequence, uint32_t first,
                                                                           uint32_t count);

}  // namespace fourdvt::evaluate
