// SPDX-License-Identifier: Apache-2.0
// The native edge of the player: answers its requests from a character folder with files and FFmpeg, and draws stills.
// The caller advances time; there is no clock.
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
  // Variant for several characters drawn into one picture with a shared recipe. rendition: see PlayerOptions.
  static Result<std::unique_ptr<CharacterPlayer>> open(gpu::Device& device, const std::string& manifest_path,
                                                       std::shared_ptr<render::Recipe> recipe,
                                                       uint32_t rendition = kHighestRendition);
  ~CharacterPlayer();
  Player& player() { return *player_; }
  render::Recipe& recipe() { return *recipe_; }
  // Substituted drawing method and its reason; empty: the character's own method is used.
  const std::string& methodNotice() const { return method_notice_; }
  // Seeks to exactly this frame (of a class: this phase at the player's parameters), pumps until it is on screen and
  // pauses. Errors: those of the player's error events.
  Status showFrame(const std::string& sequence, uint32_t frame);
  // Advances playback by this time, at most 0.25 s, for movies. Loads and decodes all due data first, so that no
  // picture is dropped. Errors: those of the player's error events.
  Status advance(double seconds);
  // Answers every pending request once.
  Status pump();
  // RGBA straight alpha, top row first, of the frame shown. scene may be null. elapsed_s: time since the previous
  // picture, for methods with temporal filtering; infinite: no previous picture.
  Result<Image> renderStill(const render::View& view, const render::RecipeOptions& options,
                            const render::Scene* scene = nullptr, float elapsed_s = render::MethodOptions().elapsed_s);

 private:
  struct HeldPicture;  // picture waiting for a slot
  struct Decoding;     // decoder and its held pictures

  CharacterPlayer(gpu::Device& device, std::shared_ptr<render::Recipe> recipe, std::string folder, uint32_t rendition);
  Status load(gpu::Device& device, const std::string& manifest_path);
  bool shows(const std::string& sequence, uint32_t frame) const;
  Decoding& decoding(int decoder);
  // One overload per kind of request.
  void answer(const FetchRange& fetch);
  void answer(const CancelFetch&) {}  // file reads are synchronous: nothing is in flight
  void answer(const ConfigureDecoder& configure);
  void answer(const DecodeSample& sample);
  void answer(const FlushDecoder& flush);
  void answer(const ResetDecoder& reset);
  void answer(const CloseDecoder& close);
  void report(int decoder, const Status& status);
  void onPicture(int decoder, const I420View& picture, int64_t timestamp_us);
  void offerHeldPictures();
  // Returns false if no slot is free.
  bool offer(int decoder, const HeldPicture& picture);
  Status takeEvents();

  std::shared_ptr<render::Recipe> recipe_;
  std::string folder_, method_notice_;
  uint32_t rendition_;
  std::unique_ptr<Player> player_;
  std::vector<Decoding> decoding_;
  std::map<std::string, Error> errors_;  // by sequence: the player reports a damaged one only once
  double now_s_ = 0;
  render::StillTarget still_;
};

}  // namespace fourdvt::edge
