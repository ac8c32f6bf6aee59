// SPDX-License-Identifier: Apache-2.0
// What a command that draws needs, in order of construction: context, device, and a character on it.
#pragma once

#include <memory>
#include <string>

#include "base/video.h"
#include "edge/character_player.h"
#include "gpu/device.h"
#include "platform/egl_context.h"

namespace fourdvt::tools {

struct GpuSession {
  std::unique_ptr<platform::EglContext> context;
  std::unique_ptr<gpu::Device> device;
};

struct CharacterSession {
  GpuSession gpu;
  std::unique_ptr<edge::CharacterPlayer> player;
  const package::Character& character() const { return *player->player().character(); }
};

Result<GpuSession> openGpu();
// `character`: a folder or its character.gltf. Opened far enough that the manifest is read.
Result<CharacterSession> openCharacter(const std::string& character);
// Opens a further character on the same context, to draw several together.
Result<std::unique_ptr<edge::CharacterPlayer>> openCharacterOn(GpuSession& gpu, const std::string& character,
                                                               std::shared_ptr<render::Recipe> recipe);
// <folder>/character.gltf for a folder, else the path itself.
std::string manifestPath(const std::string& character);
// How its figures are drawn, by name: of layered characters "montage4d", which a device that cannot run it replaces by
// the plain blend after a line on stderr; of others a method of render/cameras/camera_method.h. Errors:
// InvalidArgument, GpuFailure, Unsupported.
Status useMethod(CharacterSession& session, const std::string& name);
// The platform's FFmpeg reader.
OpenVideo videoOpener();

}  // namespace fourdvt::tools
