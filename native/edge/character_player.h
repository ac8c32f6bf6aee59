// SPDX-License-Identifier: Apache-2.0
// The native edge of the player: answers its requests from a character folder with files and FFmpeg, and draws stills.
// Does NOT pace anything: time is what the caller says.
#pragma once

#include <memory>
#include <string>

#include "base/image.h"
#include "player/player.h"

namespace fourdvt::edge {

class CharacterPlayer {
 public:
  // `manifest_path`: character.gltf or its folder. Needs a current GL context for a GLES device.
  static Result<std::unique_ptr<CharacterPlayer>> open(gpu::Device& device, const std::string& manifest_path);
  // Several characters that are drawn into one picture share a recipe. rendition: as of PlayerOptions.
  static Result<std::unique_ptr<CharacterPlayer>> open(gpu::Device& device, const std::string& manifest_path,
                                                       std::shared_ptr<render::Recipe> recipe,
                                                       uint32_t rendition = kHighestRendition);
  virtual ~CharacterPlayer() = default;
  virtual Player& player() = 0;
  virtual render::Recipe& recipe() = 0;
  // Which method is drawn in place of the character's own, and why; empty: its own is.
  virtual const std::string& methodNotice() const = 0;
  // Shows exactly this frame (of a class: this phase at the player's parameters) and pauses. Seeks and pumps until the
  // frame is on screen. Errors: those of the player's error events.
  virtual Status showFrame(const std::string& sequence, uint32_t frame) = 0;
  // Plays on by this much time, at most 0.25 s, for movies. Loads and decodes first whatever is due, so that no picture
  // is lost. Errors: those of the player's error events.
  virtual Status advance(double seconds) = 0;
  // Answers every pending request once.
  virtual Status pump() = 0;
  // RGBA straight alpha, top row first, of what is shown. scene: null: none. elapsed_s: since the picture before it,
  // for methods that follow with time; infinite: it has none.
  virtual Result<Image> renderStill(const render::View& view, const render::RecipeOptions& options,
                                    const render::Scene* scene = nullptr,
                                    float elapsed_s = render::MethodOptions().elapsed_s) = 0;
};

}  // namespace fourdvt::edge
