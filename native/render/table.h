// SPDX-License-Identifier: Apache-2.0
// Table textures: index → (index % CharacterModel::kTableWidth, index / kTableWidth), whole rows. Used by render/ and
// bake/align.
#pragma once

#include <algorithm>

#include "render/character_model.h"

namespace fourdvt::render {

inline uint32_t tableRows(uint64_t texels) {
  return static_cast<uint32_t>(
      std::max<uint64_t>(1, (texels + CharacterModel::kTableWidth - 1) / CharacterModel::kTableWidth));
}

inline Result<gpu::Texture> makeTable(gpu::Device& device, gpu::PixelFormat format, uint64_t texels,
                                      const char* label) {
  return gpu::makeTexture(device, {.format = format,
                                   .width = CharacterModel::kTableWidth,
                                   .height = static_cast<int>(tableRows(texels)),
                                   .label = label});
}

// Resizes to whole rows, filled with `fill`.
template <class T>
void resizeToRows(std::vector<T>& table, uint64_t texels, T fill) {
  table.assign(static_cast<size_t>(tableRows(texels)) * CharacterModel::kTableWidth, fill);
}

// Uploads a table of whole rows.
template <class T>
void uploadTable(gpu::Device& device, const gpu::Texture& texture, const std::vector<T>& table) {
  const int rows = static_cast<int>(table.size() / CharacterModel::kTableWidth);
  device.updateTexture(texture.id(), {.width = CharacterModel::kTableWidth, .height = rows}, table.data());
}

}  // namespace fourdvt::render
