// SPDX-License-Identifier: Apache-2.0
// Commands and queries.
#include <algorithm>
#include <cmath>

#include "base/later.h"
#include "player/player_impl.h"

namespace fourdvt {

namespace {

constexpr size_t kReordered = 4;      // samples a decoder may hold back
constexpr size_t kPacedSamples = 60;  // samples before a <video> element starts

Track makeTrack(int decoder, const PlayerOptions& options) {
  return {decoder, options.picture_slots, options.picture_kind, options.paced ? kPacedSamples : kReordered};
}

}  // namespace

Result<std::unique_ptr<Player>> Player::create(gpu::Device& device, const PlayerOptions& options) {
  auto recipe = render::Recipe::create(device);
  if (!recipe.ok()) return recipe.error();
  return create(device, recipe.take(), options);
}

Result<std::unique_ptr<Player>> Player::create(gpu::Device& device, std::shared_ptr<render::Recipe> recipe,
                                               const PlayerOptions& options) {
  if (options.picture_slots < 2) return Error{ErrorId::InvalidArgument, "picture_slots must be at least 2"};
  return std::unique_ptr<Player>(new PlayerImpl(device, options, std::move(recipe)));
}

PlayerImpl::PlayerImpl(gpu::Device& device, const PlayerOptions& options, std::shared_ptr<render::Recipe> recipe)
    : Player(device, options, std::move(recipe), render::Align::Baked),
      options_(options),
      loading_(outbox_, options.encoded_budget_bytes, options.rendition),
      tracks_{makeTrack(0, options), makeTrack(1, options)},
      parameters_(options.parameter_rate) {
  loading_.allowGraph(options.transitions);
}

Status PlayerImpl::loadManifest(const FlatJson& gltf, std::span<const uint8_t> start) {
  Status read = loading_.readManifest(gltf, start);
  if (read.ok() && loading_.hasMesh()) read = composer_.setMesh(device_, *character(), loading_.mesh());
  if (!read.ok()) {
    fail(read.error(), -1);
    return read;
  }
  if (fromCameras()) {
    auto model = later<&render::CharacterModel::createForSurfaces>(device_, *character());
    if (!model.ok()) {
      fail(model.error(), -1);
      return model.error();
    }
    composer_.setModel(model.take());
  }
  const int first = wanted_name_.empty() ? 0 : loading_.find(wanted_name_);
  outbox_.emit(EventKind::LoadedMetadata);
  selectFirst(std::max(first, 0));
  if (first < 0) return Error{ErrorId::InvalidArgument, "the character has no sequence named " + wanted_name_};
  return {};
}

bool PlayerImpl::runs(const Track& t) const {
  return playback_.running() && !t.head.seeking() && (isMain(t) || transitions_.fading());
}

bool PlayerImpl::isReady(const Track& t) const {
  return t.head.used() && composer_.hasMesh() && loading_.playable(t.head.sequence());
}

uint32_t PlayerImpl::frameOf(const Track& t, int64_t k) const {
  return static_cast<uint32_t>(k % wantedOf(t).frame_count);
}

uint32_t PlayerImpl::shownFrameOf(const Track& t) const {
  return static_cast<uint32_t>(t.head.shown().k % shownOf(t).frame_count);
}

// True on the last frame of a motion that neither loops nor leads to another: after a seek, or at a stored position.
bool PlayerImpl::standsAtTheEnd() const {
  return hasFrame() && !seeking() && !inPhase() && transitions_.returnTo() < 0 && !loops(main()) &&
         shownFrameOf(main()) + 1 == wantedOf(main()).frame_count;
}

void PlayerImpl::play() {
  if (!playback_.play() || !main().head.used()) return;
  if (main().head.ended() || standsAtTheEnd()) startAt(main(), 0);
  for (Track& t : tracks_) {
    t.head.setRunning(runs(t));
    if (t.head.used()) feedAgain(t);
  }
  if (!seeking()) playback_.emitPlaying();
}

void PlayerImpl::setRate(double rate) {
  playback_.setRate(rate);
  for (Track& t : tracks_) t.head.setRunning(runs(t));
}

void PlayerImpl::pause() {
  if (!playback_.pause()) return;
  for (Track& t : tracks_) t.head.setRunning(false);
}

void PlayerImpl::seekFrame(uint32_t frame) {
  if (!main().head.used()) return;
  leaveStart();
  giveUpTransition();
  playback_.requestSeek();
  startAt(main(), std::min(frame, wantedOf(main()).frame_count - 1));
}

void PlayerImpl::seek(double time_s) {
  if (!main().head.used() || !std::isfinite(time_s)) return;
  leaveStart();
  const package::Sequence& sequence = wantedOf(main());
  seekFrame(static_cast<uint32_t>(
      std::clamp(time_s * sequence.fps + 1e-6, 0.0, static_cast<double>(sequence.frame_count - 1))));
}

Status PlayerImpl::selectSequence(const std::string& name) {
  noteCommand();
  wanted_name_ = name;
  if (!character()) return {};
  const int sequence = loading_.find(name);
  if (sequence < 0) return Error{ErrorId::InvalidArgument, "the character has no sequence named " + name};
  giveUpTransition();
  transitions_.forgetReturn();
  transitions_.setGoal(sequence);
  if (starting() && sequence == 0 && !loading_.broken(0)) return {};
  if (loading_.revive(sequence) || sequence != main().head.sequence()) select(sequence);
  return {};
}

Status PlayerImpl::goTo(const std::string& state) {
  noteCommand();
  const int target = loading_.find(state);
  const bool by_graph = playback_.running() && hasFrame() && !loading_.lacksGraph();
  if (target < 0 || !by_graph || loading_.broken(main().head.sequence())) return selectSequence(state);
  later<&PlayerImpl::goByGraph>(*this, target);
  return {};
}

void PlayerImpl::select(int sequence) {
  transitions_.setGoal(sequence);
  main().head.select(sequence);
  startAt(main(), 0);
}

// Selects the start file's frame 0 of the first sequence until the streamed one is loaded.
void PlayerImpl::selectFirst(int sequence) {
  if (sequence > 0 || loading_.startSequence() < 0) return select(sequence);
  transitions_.setGoal(sequence);
  main().head.select(loading_.startSequence());
  startAt(main(), 0);
}

void PlayerImpl::leaveStart() {
  if (starting()) main().head.select(0);
}

void PlayerImpl::startAt(Track& t, int64_t frame) {
  t.head.seek(frame, wantedOf(t).fps);
  t.parameters.setEntry({});
  if (isMain(t)) playback_.forgetStarvation();
  stopFeed(t);
  if (loading_.playable(t.head.sequence())) restartFeed(t);
  requestMissing();
}

// Resumes feeding from the shown frame for a sequence that was fed to its end and now loops.
void PlayerImpl::setLoop(int loop) {
  playback_.setLoop(loop);
  for (Track& t : tracks_) {
    if (!isReady(t) || !(t.feeding.done() || t.feeding.lost()) || !loops(t)) continue;
    if (!t.head.hasPicture() || t.head.seeking()) continue;
    t.head.seekShown();
    restartFeed(t);
  }
}

void PlayerImpl::setQuality(uint32_t rendition, uint32_t max_texels) {
  loading_.ladder().setQuality(rendition, max_texels);
  if (rendition == kAutomaticRendition || !character()) return;
  loading_.dropOtherRenditions();
  for (Track& t : tracks_) {
    if (!isReady(t) || starting()) continue;
    if (t.head.hasPicture() && !t.head.seeking()) t.head.seekShown();
    restartFeed(t);
  }
}

void PlayerImpl::judgeRendition(uint32_t sequence, uint32_t rendition, bool plays) {
  if (!character() || sequence >= character()->sequences.size()) return;
  const package::Sequence& s = character()->sequences[sequence];
  if (rendition < s.renditions.size()) loading_.ladder().judge(s, rendition, plays);
}

void PlayerImpl::sliceDecoding(const DecodeSlice& slice) { loading_.sliceDecoding(slice); }

void PlayerImpl::decodeElsewhere(bool on) { loading_.decodeElsewhere(on); }
std::optional<DecodeJob> PlayerImpl::decodeJob(size_t number) { return loading_.decodeJob(number); }
bool PlayerImpl::takeDecoded(uint32_t job, uint32_t row, std::span<const uint8_t> bytes, double seconds) {
  return loading_.takeDecoded(job, row, bytes, seconds);
}
const package::BaseMesh* PlayerImpl::mesh() const { return loading_.hasMesh() ? &loading_.mesh() : nullptr; }
const package::ChunkMesh* PlayerImpl::chunkMesh() const { return loading_.hasMesh() ? &loading_.chunkMesh() : nullptr; }

Status PlayerImpl::setParameter(const std::string& name, double value, bool at_once) {
  if (!std::isfinite(value)) return Error{ErrorId::InvalidArgument, name + " must be a number"};
  const package::Character* c = character();
  if (c && std::none_of(c->sequences.begin(), c->sequences.end(),
                        [&](const auto& s) { return motion::findParameter(s, name) >= 0; }))
    return Error{ErrorId::InvalidArgument, "the character has no parameter named " + name};
  parameters_.set(name, value);
  if (at_once) {
    glideParameters(1e9);
    stagePictures();
  }
  return {};
}

double PlayerImpl::parameter(const std::string& name) const {
  if (hasFrame()) {
    const int p = motion::findParameter(shownOf(main()), name);
    if (p >= 0) return main().parameters.value(static_cast<size_t>(p));
  }
  for (int i = 0; i < loading_.sequenceCount(); ++i) {
    const int p = motion::findParameter(loading_.sequence(i), name);
    if (p >= 0) return parameters_.wanted(loading_.sequence(i), static_cast<size_t>(p));
  }
  return std::nan("");
}

void PlayerImpl::glideParameters(double dt_s) {
  for (Track& t : tracks_) {
    if (!t.head.hasPicture() || !(isMain(t) || transitions_.fading())) continue;
    if (t.parameters.glide(shownOf(t), parameters_, dt_s)) t.frame.markStale();
  }
}

std::string PlayerImpl::goal() const {
  return transitions_.goal() < 0 ? wanted_name_ : loading_.sequence(transitions_.goal()).name;
}

const package::Sequence* PlayerImpl::sequence() const {
  if (!main().head.used()) return nullptr;
  return starting() ? &loading_.sequence(0) : &wantedOf(main());
}

uint32_t PlayerImpl::frame() const {
  const Track& t = main();
  if (!t.head.used()) return 0;
  return hasFrame() ? shownFrameOf(t) : frameOf(t, t.head.wantedK());
}

double PlayerImpl::currentTime() const {
  const Track& t = main();
  if (!t.head.used()) return 0;
  if (t.head.ended()) return wantedOf(t).duration_s();
  return frameOf(t, hasFrame() ? t.head.position() : t.head.wantedK()) / wantedOf(t).fps;
}

double PlayerImpl::clockTime() const {
  const Track& t = main();
  if (!t.head.used()) return 0;
  const package::Sequence& s = wantedOf(t);
  const double frames = t.head.clockFrames(s.fps);
  return (frames - std::floor(frames / s.frame_count) * s.frame_count) /
         s.fps;  // fmod would be linked into the module's first part
}

std::optional<TimeRange> PlayerImpl::buffered(size_t number) const {
  const int sequence = main().head.sequence();
  if (sequence < 0 || starting() || !loading_.playable(sequence)) return {};
  const auto& chunks = loading_.index(sequence).chunks;
  const double fps = wantedOf(main()).fps;
  for (size_t first = 0; first < chunks.size(); ++first) {
    size_t end = first;
    while (end < chunks.size() && loading_.holds(sequence, static_cast<uint32_t>(end))) ++end;
    if (end == first) continue;
    if (number-- == 0) {
      const package::ChunkEntry& last = chunks[end - 1];
      return TimeRange{chunks[first].first_frame / fps, (last.first_frame + last.frame_count) / fps};
    }
    first = end;
  }
  return {};
}

PlayerStats PlayerImpl::stats() const {
  PlayerStats stats = stats_;
  stats.decoded = loading_.decodeStats();
  stats.bytes_fetched = loading_.bytesFetched();
  stats.encoded_bytes_held = loading_.encodedBytesHeld();
  if (hasFrame()) stats.rendition = main().slots.rendition(main().head.shown().slot);
  return stats;
}

}  // namespace fourdvt
