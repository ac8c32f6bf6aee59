// SPDX-License-Identifier: Apache-2.0
#include "edge/room_file.h"

#include <filesystem>

#include "base/hash.h"
#include "platform/files.h"

namespace fourdvt::edge {

Result<Image> readRoomPicture(const std::string& folder, const package::Room& room) {
  const std::string file = (std::filesystem::path(folder) / room.picture_uri).string();
  FOURDVT_ASSIGN(const auto bytes, platform::readFile(file));
  if (bytes.size() != room.picture_bytes || fnv1a(bytes) != room.picture_hash)
    return Error{ErrorId::FilesDiffer,
                 file + ": its bytes are not those that were baked with character.gltf; copy or bake it again"};
  FOURDVT_ASSIGN(const Image picture, platform::readImage(file));
  if (picture.width != room.width || picture.height != room.height)
    return Error{ErrorId::FileUnreadable, file + ": has another size than the manifest says; bake the character again"};
  if (picture.channels == 4) return picture;
  Image rgba(picture.width, picture.height, 4, 255);
  for (size_t i = 0; i < picture.pixels.size(); ++i) rgba.pixels[i / 3 * 4 + i % 3] = picture.pixels[i];
  return rgba;
}

Result<render::Scene> openRoom(gpu::Device& device, const std::string& manifest, const package::Character& character) {
  const package::Room& room = character.room;
  if (room.picture_uri.empty())
    return Error{ErrorId::InvalidArgument,
                 manifest + ": the character has no room; give \"room\" in capture.json and bake it again"};
  FOURDVT_ASSIGN(const Image picture, readRoomPicture(std::filesystem::path(manifest).parent_path().string(), room));
  render::Scene scene;
  FOURDVT_TRY(render::setRoom(device, room, scene));
  const gpu::TextureId texture = scene.room_picture.id();
  device.updateTexture(texture, {.width = room.width, .height = room.height}, picture.pixels.data());
  device.generateMipmaps(texture);
  scene.ground_y_m = static_cast<float>(character.ground_y_m);
  return scene;
}

}  // namespace fourdvt::edge
