// SPDX-License-Identifier: Apache-2.0
// The native edge of the player: answers its requests from a character folder with files and FFmpeg, and draws stills.
// Does NOT pace anything: time is what the caller says.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/image.h"
#include "player/player.h"
#include "render/still_target.h"

namespace fourdvt::edge {

class CharacterPlayer {
 public:
  // `manifest_path`: character.gltf or its folder. Needs a current GL context for a GLES device.
  static Result<std::unique_ptr<CharacterPlayer>> open(gpu::Device& device, const std::string& manifest_path);
  // Several characters that are drawn into one picture share a recipe. rendition: as of PlayerOptions.
  static Result<std::unique_ptr<CharacterPlayer>> open(gpu::Device& device, const std::string& manifest_path,
                                                       std::shared_ptr<render::Recipe> recipe,
                                                       uint32_t rendition = kHighestRendition);
  ~CharacterPlayer();
  Player& player() { return *player_; }
  render::Recipe& recipe() { return *recipe_; }
  // Which method is drawn in place of the character's own, and why; empty: its own is.
  const std::string& methodNotice() const { return method_notice_; }
  // Shows exactly this frame (of a class: this phase at the player's parameters) and pauses. Seeks and pumps until the
  // frame is on screen. Errors: those of the player's error events.
  Status showFrame(const std::string& sequence, uint32_t frame);
  // Plays on by this much time, at most 0.25 s, for movies. Loads and decodes first whatever is due, so that no picture
  // is lost. Errors: those of the player's error events.
  Status advance(double seconds);
  // Answers every pending request once.
  Status pump();
  // RGBA straight alpha, top row first, of what is shown. scene: null: none. elapsed_s: since the picture before it,
  // for methods that follow with time; infinite: it has none.
  Result<Image> renderStill(const render::View& view, const render::RecipeOptions& options,
                            const render::Scene* scene = nullptr, float elapsed_s = render::MethodOptions().elapsed_s);

 private:
  struct HeldPicture;  // waits for a slot
  struct Decoding;     // a decoder and its held pictures

  CharacterPlayer(gpu::Device& device, std::shared_ptr<render::Recipe> recipe, std::string folder, uint32_t rendition);
  Status load(gpu::Device& device, const std::string& manifest_path);
  bool shows(const std::string& sequence, uint32_t frame) const;
  Decoding& decoding(int decoder);
  // One overload per kind of request.
  void answer(const FetchRange& fetch);
  void answer(const CancelFetch&) {}  // files answer at once: nothing is ever under way
  void answer(const ConfigureDecoder& configure);
  void answer(const DecodeSample& sample);
  void answer(const FlushDecoder& flush);
  void answer(const ResetDecoder& reset);
  void answer(const CloseDecoder& close);
  void report(int decoder, const Status& status);
  void onPicture(int decoder, const I420View& picture, int64_t timestamp_us);
  void offerHeldPictures();
  // False if no slot is free now.
  bool offer(int decoder, const HeldPicture& picture);
  Status takeEvents();

  std::shared_ptr<render::Recipe> recipe_;
  std::string folder_, method_notice_;
  uint32_t rendition_;
  std::unique_ptr<Player> player_;
  std::vector<Decoding> decoding_;
  std::map<std::string, Error> errors_;  // by sequence: the player reports a broken one only once
  double now_s_ = 0;
  render::StillTarget still_;
};

}  // namespace fourdvt::edge
