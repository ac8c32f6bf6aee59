// SPDX-License-Identifier: Apache-2.0
#include "platform/character_player.h"

#include <algorithm>
#include <deque>
#include <filesystem>
#include <map>

#include "platform/ffmpeg_video.h"
#include "platform/files.h"

namespace fourdvt::platform {
namespace {

constexpr double kTick_s = 0.01;
constexpr int kMaxTicksPerFrame = 4000;  // far above what a seek needs; a character that never answers is an error

// A picture that waits for a slot, copied out of the decoder.
struct HeldPicture {
  int64_t timestamp_us = 0;
  int width = 0, height = 0;
  std::vector<uint8_t> planes;  // y, u, v, tightly packed

  HeldPicture(const I420View& view, int64_t timestamp)
      : timestamp_us(timestamp), width(view.width), height(view.height) {
    append(view.y, view.stride_y, width, height);
    append(view.u, view.stride_u, width / 2, height / 2);
    append(view.v, view.stride_v, width / 2, height / 2);
  }
  I420View view() const {
    const uint8_t* y = planes.data();
    const uint8_t* u = y + size_t(width) * height;
    const uint8_t* v = u + size_t(width / 2) * (height / 2);
    return {width, height, y, u, v, width, width / 2, width / 2};
  }

 private:
  void append(const uint8_t* plane, int stride, int plane_width, int plane_height) {
    for (int row = 0; row < plane_height; ++row) {
      const uint8_t* start = plane + ptrdiff_t(row) * stride;
      planes.insert(planes.end(), start, start + plane_width);
    }
  }
};

void unpremultiply(Image& image) {
  for (size_t i = 0; i + 3 < image.pixels.size(); i += 4) {
    uint8_t* p = &image.pixels[i];
    if (p[3] == 0 || p[3] == 255) continue;
    for (int c = 0; c < 3; ++c) p[c] = static_cast<uint8_t>(std::min(255, (p[c] * 255 + p[3] / 2) / p[3]));
  }
}

class FilePlayer final : public CharacterPlayer {
 public:
  FilePlayer(gpu::Device& device, std::string folder) : device_(device), folder_(std::move(folder)) {}

  Status load(const std::string& manifest_path) {
    auto json = readJsonFlat(manifest_path);
    if (!json.ok()) return json.error();
    auto player = Player::create(device_, {});
    if (!player.ok()) return player.error();
    player_ = player.take();
    return player_->loadManifest(json.value());
  }

  Player& player() override { return *player_; }
  Status showFrame(const std::string& sequence, uint32_t frame) override;
  Status pump() override;
  Result<Image> renderStill(const render::View& view, const render::RecipeOptions& options) override;

 private:
  bool shows(const std::string& sequence, uint32_t frame) const {
    const package::Sequence* current = player_->sequence();
    return player_->hasFrame() && !player_->seeking() && current && current->name == sequence &&
           player_->frame() == frame;
  }
  // One overload a request.
  void answer(const FetchRange& fetch);
  void answer(const CancelFetch&) {}  // files answer at once: nothing is ever under way
  void answer(const ConfigureDecoder& configure);
  void answer(const DecodeSample& sample);
  void answer(const FlushDecoder&) { report(decoder_ ? decoder_->flush() : Status()); }
  void answer(const ResetDecoder&);
  void report(const Status& status);
  void onPicture(const I420View& picture, int64_t timestamp_us);
  void offerHeldPictures();
  // False if no slot is free now.
  bool offer(const I420View& picture, int64_t timestamp_us);
  Status takeEvents();
  Status prepareTarget(int width, int height);

  gpu::Device& device_;
  std::string folder_;
  std::unique_ptr<Player> player_;
  std::unique_ptr<SampleDecoder> decoder_;
  std::deque<HeldPicture> held_;
  std::map<std::string, Error> errors_;  // by sequence: the player reports a broken one only once
  double now_s_ = 0;
  gpu::Texture color_;
  gpu::Target target_;
  int target_width_ = 0, target_height_ = 0;
};

void FilePlayer::answer(const FetchRange& fetch) {
  auto bytes = readFileRange(folder_ + "/" + fetch.uri, fetch.offset, fetch.bytes);
  if (bytes.ok()) {
    player_->onRangeReceived(fetch.id, bytes.value());
  } else {
    player_->onRangeFailed(fetch.id, bytes.error().message);
  }
}

void FilePlayer::answer(const ConfigureDecoder& configure) {
  held_.clear();
  auto decoder = SampleDecoder::create(
      configure.codec, configure.description,
      [this](const I420View& picture, int64_t timestamp_us) { onPicture(picture, timestamp_us); });
  if (decoder.ok()) {
    decoder_ = decoder.take();
  } else {
    decoder_.reset();
    report(decoder.error());
  }
}

void FilePlayer::answer(const DecodeSample& sample) {
  if (decoder_) report(decoder_->decode(sample.bytes, sample.timestamp_us, sample.key));
}

void FilePlayer::answer(const ResetDecoder&) {
  held_.clear();
  if (decoder_) decoder_->reset();
}

void FilePlayer::report(const Status& status) {
  if (status.ok()) return;
  const bool unsupported = status.error().id == ErrorId::DecoderUnsupported;
  player_->onDecoderFailed((unsupported ? "unsupported: " : "") + status.error().message);
}

bool FilePlayer::offer(const I420View& picture, int64_t timestamp_us) {
  const int slot = player_->acquireSlot(timestamp_us);
  if (slot == -1) return false;
  if (slot < 0) return true;
  player_->uploadI420(slot, picture);
  player_->commitSlot(slot);
  return true;
}

void FilePlayer::onPicture(const I420View& picture, int64_t timestamp_us) {
  if (held_.empty() && offer(picture, timestamp_us)) return;
  held_.emplace_back(picture, timestamp_us);
}

void FilePlayer::offerHeldPictures() {
  while (!held_.empty() && offer(held_.front().view(), held_.front().timestamp_us)) held_.pop_front();
}

// Remembers errors and returns the first one.
Status FilePlayer::takeEvents() {
  Status first;
  for (Event event; player_->nextEvent(event);) {
    if (event.kind != EventKind::Error) continue;
    if (const package::Sequence* current = player_->sequence()) errors_.emplace(current->name, event.error);
    if (first.ok()) first = event.error;
  }
  return first;
}

Status FilePlayer::pump() {
  offerHeldPictures();
  for (Request request; player_->nextRequest(request);) {
    std::visit([this](const auto& r) { answer(r); }, request);
  }
  return takeEvents();
}

Status FilePlayer::showFrame(const std::string& sequence, uint32_t frame) {
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
  if (shows(sequence, frame)) return {};
  player_->pause();
  FOURDVT_TRY(player_->selectSequence(sequence));
  player_->seekFrame(frame);
  for (int tick = 0; tick < kMaxTicksPerFrame; ++tick) {
    player_->tick(now_s_ += kTick_s);
    if (shows(sequence, frame)) return {};
    FOURDVT_TRY(pump());
  }
  return Error{ErrorId::VideoInvalid, folder_ + "/" + wanted->renditions[0].video_uri + ": frame " +
                                          std::to_string(frame) + " never came out of the decoder; bake again"};
}

Status FilePlayer::prepareTarget(int width, int height) {
  if (target_ && width == target_width_ && height == target_height_) return {};
  gpu::TextureDesc texture;
  texture.width = width;
  texture.height = height;
  texture.label = "still";
  auto color = gpu::makeTexture(device_, texture);
  if (!color.ok()) return color.error();
  gpu::TargetDesc desc;
  desc.colors = {color.value().id()};
  desc.width = width;
  desc.height = height;
  desc.label = "still";
  auto target = gpu::makeTarget(device_, desc);
  if (!target.ok()) return target.error();
  target_ = target.take();
  color_ = color.take();
  target_width_ = width;
  target_height_ = height;
  return {};
}

Result<Image> FilePlayer::renderStill(const render::View& view, const render::RecipeOptions& options) {
  const int largest = device_.caps().max_texture_size;
  if (view.width < 1 || view.height < 1 || view.width > largest || view.height > largest) {
    return Error{ErrorId::InvalidArgument, "picture size must be between 1 and " + std::to_string(largest) + " pixels"};
  }
  FOURDVT_TRY(prepareTarget(view.width, view.height));
  FOURDVT_TRY(player_->draw(view, options, target_.id()));
  Image image(view.width, view.height, 4);
  FOURDVT_TRY(
      device_.readPixels(target_.id(), gpu::PixelFormat::RGBA8, 0, 0, view.width, view.height, image.pixels.data()));
  unpremultiply(image);
  return image;
}

}  // namespace

Result<std::unique_ptr<CharacterPlayer>> CharacterPlayer::open(gpu::Device& device, const std::string& manifest_path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  fs::path manifest(manifest_path);
  if (fs::is_directory(manifest, ignored)) manifest /= "character.gltf";
  fs::path folder = manifest.parent_path();
  if (folder.empty()) folder = ".";
  auto player = std::make_unique<FilePlayer>(device, folder.string());
  FOURDVT_TRY(player->load(manifest.string()));
  return std::unique_ptr<CharacterPlayer>(std::move(player));
}

}  // namespace fourdvt::platform
