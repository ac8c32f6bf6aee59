// SPDX-License-Identifier: Apache-2.0
#include "player/live_player.h"

#include <algorithm>
#include <cmath>

#include "package/barcode.h"

namespace fourdvt {
namespace {

constexpr size_t kMaxWaiting = 8;      // frames; their bytes: at most 8 · kMaxLiveFrameBytes
constexpr size_t kMaxBehind = 3;       // queued frames before a key that are still decoded
constexpr int64_t kMaxInDecoder = 12;  // samples in flight
constexpr int64_t kSerialStep_us = 40000;
constexpr int kMaxLosses = 3, kMaxBadPictures = 8;     // consecutive
constexpr int kNoLiveSlotNow = -1, kNobodyWaits = -2;  // results of Player::acquireSlot

bool isFed(const auto& frame) { return frame.fed; }

}  // namespace

Result<std::unique_ptr<LivePlayer>> LivePlayer::create(gpu::Device& device, std::shared_ptr<render::Recipe> recipe,
                                                       const PlayerOptions& options) {
  if (options.picture_slots < 2)
    return Error{ErrorId::InvalidArgument, "a live stream needs picture_slots of at least 2"};
  return std::unique_ptr<LivePlayer>(new LivePlayer(device, std::move(recipe), options));
}

LivePlayer::LivePlayer(gpu::Device& device, std::shared_ptr<render::Recipe> recipe, const PlayerOptions& options)
    : Player(device, options, std::move(recipe), render::Align::None),
      on_gpu_(options.picture_kind == render::PictureTextures::Kind::Rgba),
      readable_(options.readable),
      slots_(options.picture_slots, options.picture_kind) {}

Status LivePlayer::loadManifest(const FlatJson& manifest, std::span<const uint8_t>) {
  if (live_) return Error{ErrorId::InvalidArgument, "a live player takes one manifest"};
  FOURDVT_ASSIGN(package::LiveCharacter live, package::readLiveManifest(manifest));
  FOURDVT_ASSIGN(render::CharacterModel model, render::CharacterModel::createForSurfaces(device_, live.character));
  composer_.setModel(std::move(model));
  live_ = std::move(live);
  outbox_.emit(EventKind::LoadedMetadata);
  return {};
}

// ---- commands ----

void LivePlayer::play() {
  failed_ = false;
  losses_ = 0;
  if (playback_.play() && hasFrame()) playback_.emitPlaying();
}

void LivePlayer::seek(double) {
  if (hasFrame()) outbox_.emit(EventKind::Seeked);
}

Status LivePlayer::selectSequence(const std::string& name) {
  if (!live_ || name == sequence()->name) return {};
  return Error{ErrorId::InvalidArgument, "a live stream has no sequence named " + name};
}

Status LivePlayer::setParameter(const std::string& name, double, bool) {
  return Error{ErrorId::InvalidArgument, "a live stream has no parameter named " + name};
}

double LivePlayer::parameter(const std::string&) const { return std::nan(""); }

std::string LivePlayer::goal() const { return live_ ? sequence()->name : std::string(); }

// ---- incoming frames ----

Status LivePlayer::onLiveFrame(std::span<const uint8_t> bytes) {
  if (!live_) return Error{ErrorId::InvalidArgument, "a live stream begins with its manifest"};
  FOURDVT_ASSIGN(const package::LiveFrame frame, package::readLiveFrame(bytes));
  const uint32_t step = last_number_ ? frame.number - *last_number_ : 1;
  if (step == 0 || step > INT32_MAX)
    return Error{ErrorId::StreamInvalid, "live stream: frames are out of order; connect again"};
  last_number_ = frame.number;
  stats_.bytes_fetched += bytes.size();
  if (step > 1) needs_key_ = true;
  if (failed_) return {};
  if (!admit(frame.key)) {
    ++stats_.frames_late;
    return {};
  }
  Frame& waiting = frames_.emplace_back();
  waiting.serial = next_serial_++;
  waiting.number = frame.number;
  waiting.key = frame.key;
  waiting.captured_us = frame.captured_us;
  waiting.chunk.assign(frame.chunk.begin(), frame.chunk.end());
  waiting.sample.assign(frame.sample.begin(), frame.sample.end());
  return {};
}

// Makes room for a frame. False: it cannot be decoded.
bool LivePlayer::admit(bool key) {
  if (needs_key_ && !key) return false;
  needs_key_ = false;
  const auto unfed = std::find_if_not(frames_.begin(), frames_.end(), isFed<Frame>);
  const auto behind = static_cast<size_t>(frames_.end() - unfed);
  if (behind >= (key ? kMaxBehind : kMaxWaiting)) {
    leaveOut(unfed, frames_.end());
    needs_key_ = !key;
    if (needs_key_) return false;
  }
  if (frames_.size() >= kMaxWaiting) leaveOut(frames_.begin(), frames_.begin() + 1);
  return true;
}

void LivePlayer::leaveOut(std::vector<Frame>::iterator first, std::vector<Frame>::iterator end) {
  for (auto frame = first; frame != end; ++frame) {
    if (frame->slot >= 0) slots_.drop(frame->slot);
    stats_.frames_late += playback_.playing();
  }
  frames_.erase(first, end);
}

void LivePlayer::forget() {
  for (const Frame& frame : frames_)
    if (frame.slot >= 0) slots_.drop(frame.slot);
  frames_.clear();
  needs_key_ = true;
  bad_pictures_ = 0;
  answered_serial_ = fed_serial_;
}

void LivePlayer::onLiveGap() {
  forget();
  last_number_.reset();
  if (!configured_) return;
  if (in_sight_) return outbox_.request(ResetDecoder{0});
  configured_ = false;
  outbox_.request(CloseDecoder{0});
}

bool LivePlayer::nextRequest(Request& out) {
  if (outbox_.nextRequest(out)) return true;
  const auto next = std::find_if_not(frames_.begin(), frames_.end(), isFed<Frame>);
  if (next == frames_.end() || fed_serial_ - answered_serial_ >= kMaxInDecoder) return false;
  if (!configured_) {
    configured_ = true;
    out = ConfigureDecoder{0, rendition().codec, {}, rendition().width, rendition().height};
    return true;
  }
  feeding_ = std::move(next->sample);
  next->fed = true;
  fed_serial_ = next->serial;
  out = DecodeSample{0, feeding_, next->serial * kSerialStep_us, next->key};
  return true;
}

// ---- pictures ----

LivePlayer::Frame* LivePlayer::frameIn(int slot) {
  for (Frame& frame : frames_)
    if (slot >= 0 && frame.slot == slot) return &frame;
  return nullptr;
}

// Free slot, or that of a ready picture older than `serial`; -1: none now.
int LivePlayer::freeSlotFor(int64_t serial) {
  const int free = slots_.findFree();
  if (free >= 0) return free;
  const auto older = std::find_if(frames_.begin(), frames_.end(), [&](const Frame& f) {
    return f.slot >= 0 && f.serial < serial && !slots_.awaits(f.slot);
  });
  if (older == frames_.end()) return -1;
  leaveOut(older, older + 1);
  return slots_.findFree();
}

int LivePlayer::acquireSlot(int decoder, int64_t timestamp_us) {
  const int64_t serial = timestamp_us / kSerialStep_us;
  const auto waits = [&](const Frame& f) { return f.fed && f.slot < 0 && f.serial == serial; };
  if (decoder != 0 || serial > fed_serial_) return kNobodyWaits;
  answered_serial_ = std::max(answered_serial_, serial);
  if (std::none_of(frames_.begin(), frames_.end(), waits)) return kNobodyWaits;
  const int slot = freeSlotFor(serial);
  if (slot < 0) return kNoLiveSlotNow;
  if (Status status = slots_.prepare(device_, slot, rendition()); !status.ok()) {
    fail(status.error());
    return kNobodyWaits;
  }
  slots_.fill(slot, serial, 0);
  std::find_if(frames_.begin(), frames_.end(), waits)->slot = slot;
  return slot;
}

void LivePlayer::uploadI420(int slot, const I420View& picture, PictureBytes bytes) {
  Frame* frame = frameIn(slot);
  if (!frame || !slots_.awaits(slot)) return;
  if (checkSize(*frame, picture.width, picture.height) &&
      checkNumber(*frame, package::readBarcode(rendition().barcode, picture)))
    slots_.hold(slot, picture, std::move(bytes));
}

bool LivePlayer::checkSize(Frame& frame, int width, int height) {
  if (width == rendition().width && height == rendition().height) return true;
  rejectPicture(frame, "its pictures have another size than its manifest says");
  return false;
}

bool LivePlayer::checkNumber(Frame& frame, std::optional<uint32_t> seen) {
  ++stats_.barcode_checked;
  if (seen == frame.number % 4096) return true;
  ++stats_.barcode_mismatches;
  rejectPicture(frame, "its pictures have other frames' barcodes");
  return false;
}

// Single damaged pictures are skipped; a run of them resets the decoder.
void LivePlayer::rejectPicture(Frame& frame, const char* reason) {
  frame.bad = true;
  slots_.reject(frame.slot);
  if (++bad_pictures_ < kMaxBadPictures) return;
  configured_ = false;
  outbox_.request(CloseDecoder{0});
  lose(DecoderFault::Samples, reason);
}

gpu::TextureId LivePlayer::slotTexture(int slot) const {
  return slots_.holds(slot) ? slots_.picture(slot).rgba.id() : 0;
}

void LivePlayer::commitSlot(int slot, int width, int height) {
  if (!slots_.holds(slot)) return;
  Frame* frame = frameIn(slot);
  if (on_gpu_ && frame && slots_.awaits(slot) && checkSize(*frame, width, height) && readable_) {
    const Status begun = checks_.begin(slot, slotTexture(slot), rendition().barcode);
    if (begun.ok()) return;  // completed by a tick
    fail(begun.error());
  }
  finishSlot(slot);
}

void LivePlayer::finishSlot(int slot) {
  slots_.commit(slot, true);
  const auto frame = std::find_if(frames_.begin(), frames_.end(), [&](const Frame& f) { return f.slot == slot; });
  if (frame == frames_.end()) return;
  if (frame->bad) {
    frames_.erase(frame);
  } else {
    losses_ = bad_pictures_ = 0;
  }
}

void LivePlayer::onDecoderFailed(int decoder, DecoderFault fault, const std::string& reason) {
  if (decoder != 0 || !live_) return;
  configured_ = false;
  lose(fault, reason);
}

void LivePlayer::lose(DecoderFault fault, const std::string& reason) {
  forget();
  if (!in_sight_ && fault == DecoderFault::TakenAway) return;
  if (fault != DecoderFault::Unsupported && ++losses_ < kMaxLosses) return;
  constexpr ErrorId kIds[] = {ErrorId::VideoInvalid, ErrorId::DecoderUnsupported, ErrorId::DecoderLost};
  fail({kIds[static_cast<size_t>(fault)], "live stream: the video does not decode (" + reason + ")"});
}

// Reports an error once, until the next `play`.
void LivePlayer::fail(Error error) {
  forget();
  if (!failed_) outbox_.emit({EventKind::Error, std::move(error), 0, 0});
  failed_ = true;
}

// ---- display ----

void LivePlayer::tick(double now_s) {
  playback_.tick(now_s);
  method_.elapsed_s = static_cast<float>(playback_.tick_s());
  if (!live_) return;
  checks_.settle([this](int slot, std::optional<uint32_t> seen) {
    Frame* frame = frameIn(slot);
    if (frame && slots_.awaits(slot)) checkNumber(*frame, seen);
    finishSlot(slot);
  });
  const bool first = !hasFrame();
  if ((first || playback_.playing()) && showNewest()) {
    shown_at_s_ = now_s;
    if (first) playback_.finishSeek(false);
  }
  if (playback_.playing() && hasFrame()) playback_.noteStarvation(now_s - shown_at_s_ > 2 / sequence()->fps);
  playback_.finishTick(!hasFrame());
}

bool LivePlayer::showNewest() {
  const int slot = slots_.newestReady(shown_.serial + 1, INT64_MAX);
  const Frame* frame = frameIn(slot);
  if (!frame || !show(*frame)) return false;
  const auto same = std::find_if(frames_.begin(), frames_.end(), [&](const Frame& f) { return f.slot == slot; });
  frames_.erase(same, same + 1);
  const auto newer =
      std::find_if(frames_.begin(), frames_.end(), [&](const Frame& f) { return f.serial > shown_.serial; });
  leaveOut(frames_.begin(), newer);
  return true;
}

bool LivePlayer::show(const Frame& frame) {
  const package::Character& character = live_->character;
  auto opened = package::SurfaceChunk::open(frame.chunk, live_->index, 0, character, *sequence());
  Status status = opened.ok() ? opened.value()->decodeTo(0) : Status(opened.error());
  if (!status.ok()) {
    outbox_.emit({EventKind::Error, {ErrorId::StreamInvalid, "live stream: " + status.error().message}, 0, 0});
    forget();
    return false;
  }
  const FrameGeometry geometry{nullptr, &live_->index, 0, opened.value().get()};
  status = surface_.present(device_, composer_.model(), character, *sequence(), rendition(), geometry);
  if (!status.ok()) {
    fail(status.error());
    return false;
  }
  surface_.blend(geometry, {});
  composer_.markStale();
  composer_.compose(device_, surface_, nullptr, {});
  if (!hasFrame()) first_captured_us_ = frame.captured_us;
  slots_.show(frame.slot);
  status = slots_.stage(device_, frame.slot, rendition(), 1, 1);
  if (!status.ok()) {
    fail(status.error());
    return false;
  }
  shown_ = {frame.slot, frame.serial, frame.number, frame.captured_us};
  ++stats_.frames_shown;
  return true;
}

Result<render::Figure> LivePlayer::figure() const {
  if (!hasFrame()) return Error{ErrorId::InvalidArgument, "nothing to draw yet: wait for canplay"};
  return composer_.cameraFigure(surface_, slots_.picture(shown_.slot), motion::worldFromCharacter(placement()));
}

double LivePlayer::currentTime() const {
  return hasFrame() ? (static_cast<double>(shown_.captured_us) - static_cast<double>(first_captured_us_)) * 1e-6 : 0;
}

PlayerStats LivePlayer::stats() const {
  PlayerStats stats = stats_;
  for (const Frame& frame : frames_) stats.encoded_bytes_held += frame.chunk.size() + frame.sample.size();
  return stats;
}

}  // namespace fourdvt
