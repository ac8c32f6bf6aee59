// SPDX-License-Identifier: Apache-2.0
#include "edge/character_player.h"

#include <algorithm>
#include <deque>
#include <filesystem>

#include "platform/ffmpeg_video.h"
#include "platform/files.h"
#include "render/cameras/camera_method.h"

namespace fourdvt::edge {
namespace {

using platform::readFileRange, platform::readJsonFlat, platform::SampleDecoder;

constexpr double kTick_s = 0.01;
constexpr int kMaxTicksPerFrame = 4000;  // far above a seek's need; reaching it is an error

}  // namespace

// Decoded picture, copied out of the decoder.
struct CharacterPlayer::HeldPicture {
  int64_t timestamp_us = 0;
  int width = 0, height = 0;
  std::shared_ptr<std::vector<uint8_t>> planes = std::make_shared<std::vector<uint8_t>>();  // y, u, v, tightly packed

  HeldPicture(const I420View& view, int64_t timestamp)
      : timestamp_us(timestamp), width(view.width), height(view.height) {
    append(view.y, view.stride_y, width, height);
    append(view.u, view.stride_u, width / 2, height / 2);
    append(view.v, view.stride_v, width / 2, height / 2);
  }
  I420View view() const {
    const uint8_t* y = planes->data();
    const uint8_t* u = y + size_t(width) * height;
    const uint8_t* v = u + size_t(width / 2) * (height / 2);
    return {width, height, y, u, v, width, width / 2, width / 2};
  }

 private:
  void append(const uint8_t* plane, int stride, int plane_width, int plane_height) {
    for (int row = 0; row < plane_height; ++row) {
      const uint8_t* start = plane + ptrdiff_t(row) * stride;
      planes->insert(planes->end(), start, start + plane_width);
    }
  }
};

struct CharacterPlayer::Decoding {
  std::unique_ptr<SampleDecoder> decoder;
  std::deque<HeldPicture> held;
};

CharacterPlayer::CharacterPlayer(gpu::Device& device, std::shared_ptr<render::Recipe> recipe, std::string folder,
                                 uint32_t rendition)
    : recipe_(std::move(recipe)),
      folder_(std::move(folder)),
      rendition_(rendition),
      decoding_(kDecoders),
      still_(device) {}

CharacterPlayer::~CharacterPlayer() = default;

Status CharacterPlayer::load(gpu::Device& device, const std::string& manifest_path) {
  FOURDVT_ASSIGN(auto json, readJsonFlat(manifest_path));
  FOURDVT_ASSIGN(player_, Player::create(device, recipe_, {.rendition = rendition_}));
  FOURDVT_TRY(player_->loadManifest(json));
  if (player_->character()->appearance == package::AppearanceKind::Layers) return {};
  FOURDVT_ASSIGN(auto made, render::makeMethodOf(device, *player_->character()));
  method_notice_ = std::move(made.notice);
  recipe_->setMethod(std::move(made.method));
  return {};
}

CharacterPlayer::Decoding& CharacterPlayer::decoding(int decoder) { return decoding_[static_cast<size_t>(decoder)]; }

bool CharacterPlayer::shows(const std::string& sequence, uint32_t frame) const {
  const package::Sequence* current = player_->sequence();
  return player_->hasFrame() && !player_->seeking() && current && current->name == sequence &&
         player_->frame() == frame;
}

void CharacterPlayer::answer(const FetchRange& fetch) {
  auto bytes = readFileRange(folder_ + "/" + fetch.uri, fetch.offset, fetch.bytes);
  if (bytes.ok()) {
    player_->onRangeReceived(fetch.id, bytes.value());
  } else {
    player_->onRangeFailed(fetch.id, bytes.error().message);
  }
}

void CharacterPlayer::answer(const ConfigureDecoder& configure) {
  const int number = configure.decoder;
  decoding(number) = {};
  auto decoder = SampleDecoder::create(
      configure.codec, configure.description,
      [this, number](const I420View& picture, int64_t timestamp_us) { onPicture(number, picture, timestamp_us); });
  if (decoder.ok())
    decoding(number).decoder = decoder.take();
  else
    report(number, decoder.error());
}

void CharacterPlayer::answer(const DecodeSample& sample) {
  if (SampleDecoder* decoder = decoding(sample.decoder).decoder.get())
    report(sample.decoder, decoder->decode(sample.bytes, sample.timestamp_us, sample.key));
}

void CharacterPlayer::answer(const FlushDecoder& flush) {
  if (SampleDecoder* decoder = decoding(flush.decoder).decoder.get()) report(flush.decoder, decoder->flush());
}

void CharacterPlayer::answer(const ResetDecoder& reset) {
  decoding(reset.decoder).held.clear();
  if (SampleDecoder* decoder = decoding(reset.decoder).decoder.get()) decoder->reset();
}

void CharacterPlayer::answer(const CloseDecoder& close) { decoding(close.decoder) = {}; }

void CharacterPlayer::report(int decoder, const Status& status) {
  if (status.ok()) return;
  const bool unsupported = status.error().id == ErrorId::DecoderUnsupported;
  player_->onDecoderFailed(decoder, unsupported ? DecoderFault::Unsupported : DecoderFault::Samples,
                           status.error().message);
}

bool CharacterPlayer::offer(int decoder, const HeldPicture& picture) {
  const int slot = player_->acquireSlot(decoder, picture.timestamp_us);
  if (slot == -1) return false;
  if (slot < 0) return true;
  player_->uploadI420(slot, picture.view(), picture.planes);
  player_->commitSlot(slot);
  return true;
}

void CharacterPlayer::onPicture(int decoder, const I420View& picture, int64_t timestamp_us) {
  std::deque<HeldPicture>& held = decoding(decoder).held;
  held.emplace_back(picture, timestamp_us);
  if (held.size() == 1 && offer(decoder, held.front())) held.pop_front();
}

void CharacterPlayer::offerHeldPictures() {
  for (int d = 0; d < kDecoders; ++d) {
    std::deque<HeldPicture>& held = decoding(d).held;
    while (!held.empty() && offer(d, held.front())) held.pop_front();
  }
}

// Records errors and returns the first one.
Status CharacterPlayer::takeEvents() {
  Status first;
  for (Event event; player_->nextEvent(event);) {
    // Forbids fallback to another rendition where one was chosen explicitly.
    if (event.kind != EventKind::Error && event.kind != EventKind::Warning) continue;
    if (const package::Sequence* current = player_->sequence()) errors_.emplace(current->name, event.error);
    if (first.ok()) first = event.error;
  }
  return first;
}

Status CharacterPlayer::pump() {
  offerHeldPictures();
  for (Request request; player_->nextRequest(request);) {
    std::visit([this](const auto& r) { answer(r); }, request);
  }
  return takeEvents();
}

Status CharacterPlayer::showFrame(const std::string& sequence, uint32_t frame) {
  const package::Character* character = player_->character();
  const package::Sequence* wanted = character ? character->find(sequence) : nullptr;
  if (!wanted) {
    return Error{ErrorId::InvalidArgument,
                 folder_ + ": no sequence named " + sequence + "; `fourdvt inspect` lists the sequences"};
  }
  if (frame >= wanted->frame_count) {
    return Error{ErrorId::InvalidArgument, folder_ + ": " + sequence + " has no frame " + std::to_string(frame) +
                                               "; its frames are 0 to " + std::to_string(wanted->frame_count - 1)};
  }
  if (auto broken = errors_.find(sequence); broken != errors_.end()) return broken->second;
  player_->pause();
  if (!shows(sequence, frame)) {
    FOURDVT_TRY(player_->selectSequence(sequence));
    player_->seekFrame(frame);
  }
  for (int tick = 0; tick < kMaxTicksPerFrame; ++tick) {
    player_->tick(now_s_ += kTick_s);
    if (shows(sequence, frame)) return {};
    FOURDVT_TRY(pump());
  }
  const size_t rendition = std::min<size_t>(rendition_, wanted->renditions.size() - 1);
  return Error{ErrorId::VideoInvalid, folder_ + "/" + wanted->renditions[rendition].video_uri + ": frame " +
                                          std::to_string(frame) + " never came out of the decoder; bake again"};
}

Status CharacterPlayer::advance(double seconds) {
  FOURDVT_TRY(pump());  // fills all slots, so that the step finds decoded pictures
  player_->tick(now_s_ += seconds);
  FOURDVT_TRY(pump());
  for (int tick = 0; player_->seeking() && tick < kMaxTicksPerFrame; ++tick) {
    player_->tick(now_s_);
    FOURDVT_TRY(pump());
  }
  return {};
}

Result<Image> CharacterPlayer::renderStill(const render::View& view, const render::RecipeOptions& options,
                                           const render::Scene* scene, float elapsed_s) {
  return still_.render(view, [&](gpu::TargetId target) -> Status {
    FOURDVT_ASSIGN(const render::Figure figure, player_->figure());
    render::MethodOptions method = player_->method();
    method.elapsed_s = elapsed_s;
    return recipe_->draw({&figure, 1}, scene, view, {options, player_->align(), method}, target);
  });
}

Result<std::unique_ptr<CharacterPlayer>> CharacterPlayer::open(gpu::Device& device, const std::string& manifest_path) {
  FOURDVT_ASSIGN(auto recipe, render::Recipe::create(device));
  return open(device, manifest_path, std::move(recipe));
}

Result<std::unique_ptr<CharacterPlayer>> CharacterPlayer::open(gpu::Device& device, const std::string& manifest_path,
                                                               std::shared_ptr<render::Recipe> recipe,
                                                               uint32_t rendition) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  fs::path manifest(manifest_path);
  if (fs::is_directory(manifest, ignored)) manifest /= "character.gltf";
  fs::path folder = manifest.parent_path();
  if (folder.empty()) folder = ".";
  std::unique_ptr<CharacterPlayer> player(new CharacterPlayer(device, std::move(recipe), folder.string(), rendition));
  FOURDVT_TRY(player->load(device, manifest.string()));
  return player;
}

}  // namespace fourdvt::edge
