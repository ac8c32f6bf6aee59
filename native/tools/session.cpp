// SPDX-License-Identifier: Apache-2.0
#include "tools/session.h"

#include <filesystem>

#include "platform/ffmpeg_video.h"

namespace fourdvt::tools {

Result<GpuSession> openGpu() {
  GpuSession session;
  FOURDVT_ASSIGN(session.context, platform::EglContext::create());
  FOURDVT_ASSIGN(session.device, gpu::createGlesDevice());
  return session;
}

Result<CharacterSession> openCharacter(const std::string& character) {
  FOURDVT_ASSIGN(auto gpu, openGpu());
  CharacterSession session{std::move(gpu), nullptr};
  FOURDVT_ASSIGN(auto recipe, render::Recipe::create(*session.gpu.device));
  FOURDVT_ASSIGN(session.player, openCharacterOn(session.gpu, character, std::move(recipe)));
  return session;
}

Result<std::unique_ptr<platform::CharacterPlayer>> openCharacterOn(GpuSession& gpu, const std::string& character,
                                                                   std::shared_ptr<render::Recipe> recipe) {
  const std::string path = manifestPath(character);
  FOURDVT_ASSIGN(auto player, platform::CharacterPlayer::open(*gpu.device, path, std::move(recipe)));
  const package::Character* read = player->player().character();
  if (!read) return Error{ErrorId::ManifestInvalid, path + ": manifest did not load"};
  if (read->sequences.empty()) return Error{ErrorId::ManifestInvalid, path + ": has no sequences; bake it again"};
  return player;
}

std::string manifestPath(const std::string& character) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(character, ignored)) return character;
  return (std::filesystem::path(character) / "character.gltf").string();
}

OpenVideo videoOpener() {
  return [](const std::string& path, int channels) { return platform::openVideoFile(path, channels); };
}

}  // namespace fourdvt::tools
