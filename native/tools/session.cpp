// SPDX-License-Identifier: Apache-2.0
#include "tools/session.h"

#include <filesystem>

#include "platform/ffmpeg_video.h"

namespace fourdvt::tools {

Result<GpuSession> openGpu() {
  GpuSession session;
  auto context = platform::EglContext::create();
  if (!context.ok()) return context.error();
  session.context = context.take();
  auto device = gpu::createGlesDevice();
  if (!device.ok()) return device.error();
  session.device = device.take();
  return session;
}

Result<CharacterSession> openCharacter(const std::string& character) {
  auto gpu = openGpu();
  if (!gpu.ok()) return gpu.error();
  CharacterSession session{gpu.take(), nullptr};
  auto recipe = render::Recipe::create(*session.gpu.device);
  if (!recipe.ok()) return recipe.error();
  auto player = openCharacterOn(session.gpu, character, recipe.take());
  if (!player.ok()) return player.error();
  session.player = player.take();
  return session;
}

Result<std::unique_ptr<platform::CharacterPlayer>> openCharacterOn(GpuSession& gpu, const std::string& character,
                                                                   std::shared_ptr<render::Recipe> recipe) {
  const std::string path = manifestPath(character);
  auto player = platform::CharacterPlayer::open(*gpu.device, path, std::move(recipe));
  if (!player.ok()) return player.error();
  const package::Character* read = player.value()->player().character();
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
