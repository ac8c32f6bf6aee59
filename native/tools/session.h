// SPDX-License-Identifier: Apache-2.0
// What a command that draws needs, in order of construction: context, device, and a character on it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/video.h"
#include "edge/character_player.h"
#include "gpu/device.h"
#include "platform/egl_context.h"
#include "tools/args.h"

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

// Opens a GPU without a screen. Shaders come from the folder that the environment variable FOURDVT_SHADERS names, if
// set.
Result<GpuSession> openGpu();
// The message with files and lines of that folder in place of the numbers in a GLSL compiler's log.
std::string withShaderLines(const std::string& message);
// `character`: a folder or its character.gltf. Opened far enough that the manifest is read. rendition: the one that is
// drawn, as --rendition takes it (findRendition); none: the highest.
Result<CharacterSession> openCharacter(const std::string& character, std::optional<int> rendition = {});
// Opens a further character on the same context, to draw several together.
Result<std::unique_ptr<edge::CharacterPlayer>> openCharacterOn(GpuSession& gpu, const std::string& character,
                                                               std::shared_ptr<render::Recipe> recipe,
                                                               std::optional<int> rendition = {});
// The index of a rendition of the first sequence: `number` itself, 0 for the lowest, or the highest one whose layer 1
// has that many texels a side. Errors: InvalidArgument, with what there is.
Result<uint32_t> findRendition(const package::Character& character, const std::string& path, int number);
// <folder>/character.gltf for a folder, else the path itself.
std::string manifestPath(const std::string& character);
// How its figures are drawn, by name: of layered characters "montage4d", which a device that cannot run it replaces by
// the plain blend after a line on stderr; of others a method of render/cameras/camera_method.h. Errors:
// InvalidArgument, GpuFailure, Unsupported.
Status useMethod(CharacterSession& session, const std::string& name);
// The platform's FFmpeg reader. `index_folder`: see platform::openIndexedVideo.
OpenVideo videoOpener(const std::string& index_folder = {});

}  // namespace fourdvt::tools
