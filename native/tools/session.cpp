// SPDX-License-Identifier: Apache-2.0
#include "tools/session.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "gpu/device.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"
#include "platform/shader_folder.h"
#include "render/cameras/camera_method.h"
#include "render/montage/layered_montage.h"
#include "tools/terminal.h"

namespace fourdvt::tools {

namespace {

std::optional<platform::ShaderFolder> shader_folder;  // set by the environment variable; outlives all shader reads

Status useShaderFolder() {
  const char* path = std::getenv("FOURDVT_SHADERS");
  if (!path || !*path || shader_folder) return {};
  FOURDVT_ASSIGN(shader_folder, platform::ShaderFolder::open(path));
  gpu::readShadersBy([](std::string_view name) { return shader_folder->text(name); });
  std::fprintf(stderr, "%s: shaders are those of %s (FOURDVT_SHADERS)\n", programName(), path);
  return {};
}

}  // namespace

std::string withShaderLines(const std::string& message) {
  return shader_folder ? shader_folder->nameLines(message) : message;
}

Result<GpuSession> openGpu() {
  FOURDVT_TRY(useShaderFolder());
  GpuSession session;
  FOURDVT_ASSIGN(session.context, platform::EglContext::create());
  FOURDVT_ASSIGN(session.device, gpu::createGlesDevice());
  detail("GPU: %s", session.device->caps().renderer.c_str());
  return session;
}

Result<CharacterSession> openCharacter(const std::string& character, std::optional<int> rendition) {
  FOURDVT_ASSIGN(auto gpu, openGpu());
  CharacterSession session{std::move(gpu), nullptr};
  FOURDVT_ASSIGN(auto recipe, render::Recipe::create(*session.gpu.device));
  FOURDVT_ASSIGN(session.player, openCharacterOn(session.gpu, character, std::move(recipe), rendition));
  return session;
}

Result<std::unique_ptr<edge::CharacterPlayer>> openCharacterOn(GpuSession& gpu, const std::string& character,
                                                               std::shared_ptr<render::Recipe> recipe,
                                                               std::optional<int> rendition) {
  const std::string path = manifestPath(character);
  detail("reads %s", path.c_str());
  uint32_t index = kHighestRendition;
  if (rendition) {
    FOURDVT_ASSIGN(const auto json, platform::readJsonFlat(path));
    FOURDVT_ASSIGN(const auto manifest, package::readManifest(json));
    FOURDVT_ASSIGN(index, findRendition(manifest, path, *rendition));
  }
  FOURDVT_ASSIGN(auto player, edge::CharacterPlayer::open(*gpu.device, path, std::move(recipe), index));
  const package::Character* read = player->player().character();
  if (!read) return Error{ErrorId::ManifestInvalid, path + ": manifest did not load"};
  if (read->sequences.empty()) return Error{ErrorId::ManifestInvalid, path + ": has no sequences; bake it again"};
  if (!player->methodNotice().empty()) std::fprintf(stderr, "%s: %s\n", programName(), player->methodNotice().c_str());
  return player;
}

Result<uint32_t> findRendition(const package::Character& character, const std::string& path, int number) {
  if (character.sequences.empty()) return 0u;
  const std::vector<package::Rendition>& all = character.sequences.front().renditions;
  if (static_cast<size_t>(number) < all.size()) return static_cast<uint32_t>(number);
  std::string known;
  for (size_t r = all.size(); r-- > 0;) {
    const int texels = all[r].layers.empty() ? 0 : all[r].layers[0].width;
    if (texels == number) return static_cast<uint32_t>(r);
    known = std::to_string(r) + (texels ? " (" + std::to_string(texels) + " texels)" : "") +
            (known.empty() ? "" : ", ") + known;
  }
  return Error{ErrorId::InvalidArgument,
               path + ": has no rendition " + std::to_string(number) + "; --rendition takes " + known};
}

std::string manifestPath(const std::string& character) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(character, ignored)) return character;
  return (std::filesystem::path(character) / "character.gltf").string();
}

Status useMethod(CharacterSession& session, const std::string& name) {
  gpu::Device& device = *session.gpu.device;
  render::Recipe& recipe = session.player->recipe();
  if (session.character().appearance == package::AppearanceKind::Cameras) {
    FOURDVT_ASSIGN(auto made, render::makeSupportedMethod(device, name));
    if (!made.notice.empty()) std::fprintf(stderr, "%s: %s\n", programName(), made.notice.c_str());
    recipe.setMethod(std::move(made.method));
    return {};
  }
  if (name != "montage4d") return Error{ErrorId::InvalidArgument, "layered characters have no method " + name};
  auto montage = render::makeLayeredMontage(device);
  if (!montage && montage.error().id == ErrorId::Unsupported)
    std::fprintf(stderr, "%s: %s; drawn by the plain blend\n", programName(), montage.error().message.c_str());
  else if (!montage)
    return montage.error();
  else
    recipe.setLayered(montage.take());
  return {};
}

OpenVideo videoOpener(const std::string& index_folder) {
  return [index_folder](const std::string& path, int channels) {
    return platform::openIndexedVideo(path, channels, index_folder);
  };
}

}  // namespace fourdvt::tools
