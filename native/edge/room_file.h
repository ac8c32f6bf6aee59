// SPDX-License-Identifier: Apache-2.0
// Room of a character folder, as a picture and as a scene.
#pragma once

#include <string>

#include "base/image.h"
#include "gpu/device.h"
#include "package/character.h"
#include "render/scene.h"

namespace fourdvt::edge {

// RGBA. `folder`: that of a character with a room. Errors: FileMissing, FileUnreadable, FilesDiffer.
Result<Image> readRoomPicture(const std::string& folder, const package::Room& room);
// Scene of the character's room. `manifest`: its character.gltf. Errors: those of readRoomPicture, GpuFailure,
// InvalidArgument if the character has no room.
Result<render::Scene> openRoom(gpu::Device& device, const std::string& manifest, const package::Character& character);

}  // namespace fourdvt::edge
