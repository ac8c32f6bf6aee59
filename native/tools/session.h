// SPDX-License-Identifier: Apache-2.0
// GPU session of a drawing command, in order of construction: context, device, and a character on it.
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

// Opens a headless GPU. Shaders come from the folder in the environment variable FOURDVT_SHADERS, if set.
Result<GpuSession> openGpu();
// Replaces line numbers in a GLSL compiler's log by files and lines of that folder.
std::string withShaderLines(const std::string& message);
// `character`: a folder or its character.gltf. Opens it and reads the manifest. rendition: the one to draw, as in
// --rendition (findRendition); none: the highest.
Result<CharacterSession> openCharacter(const std::string& character, std::optional<int> rendition = {});
// Opens a further character on the same context, to draw several together.
Result<std::unique_ptr<edge::CharacterPlayer>> openCharacterOn(GpuSession& gpu, const std::string& character,
                                                               std::shared_ptr<render::Recipe> recipe,
                                                               std::optional<int> rendition = {});
// Index of a rendition of the first sequence: `number` itself, 0 for the lowest, or the highest one whose layer 1 has
// that many texels a side. Errors: InvalidArgument, listing the renditions.
Result<uint32_t> findRendition(const package::Character& character, const std::string& path, int number);
// <folder>/character.gltf for a folder, else the path itself.
std::string manifestPath(const std::string& character);
// Selects the drawing method by name: for layered characters "montage4d", with a fallback to the plain blend and a line
// on stderr if the device cannot run it; for others a method of render/cameras/camera_method.h. Errors:
// InvalidArgument, GpuFailure, Unsupported.
Status useMethod(CharacterSession& session, const std::string& name);
// The platform's FFmpeg reader. `index_folder`: see platform::openIndexedVideo.
OpenVideo videoOpener(const std::string& index_folder = {});

}  // namespace fourdvt::tools
