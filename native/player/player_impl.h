// SPDX-License-Identifier: Apache-2.0
// Implementation of player.h, private to native/player: combines the parts; decisions within one part stay there.
// player.cpp: commands and queries; player_loading.cpp: fetches; player_pictures.cpp: decoder input and output;
// player_tick.cpp: a tick; player_transitions.cpp: steps of a transition; player_figure.cpp: drawing.
#pragma once

#include <array>
#include <optional>

#include "base/later.h"
#include "player/parts/pictures.h"
#include "player/player.h"

namespace fourdvt {

// One sequence played by one decoder: the parts that each track owns. A player has two tracks; the second is used only
// around a transition.
struct Track {
  Track(int decoder, int picture_slots, render::PictureTextures::Kind kind, size_t samples_ahead)
      : feeding(decoder, samples_ahead), slots(picture_slots, kind) {}

  Playhead head;
  Feeding feeding;
  PictureSlots slots;
  ShownParameters parameters;
  RootTrail roots;
  ShownFrame frame;
};

class PlayerImpl final : public Player {
 public:
  PlayerImpl(gpu::Device& device, const PlayerOptions& options, std::shared_ptr<render::Recipe> recipe);

  Status loadManifest(const FlatJson& gltf, std::span<const uint8_t> start) override;
  bool hasMesh() const override { return composer_.hasMesh(); }
  void play() override;
  void pause() override;
  void seekFrame(uint32_t frame) override;
  void seek(double time_s) override;
  Status selectSequence(const std::string& name) override;
  void setRate(double rate) override;
  void setLoop(int loop) override;
  Status setParameter(const std::string& name, double value, bool at_once) override;
  double parameter(const std::string& name) const override;
  Status goTo(const std::string& state) override;
  void allowTransitions() override { loading_.allowGraph(true); }
  bool inTransition() const override { return transitions_.fading(); }
  std::string goal() const override;
  void setAlign(render::Align align) override { align_ = align; }
  void setQuality(uint32_t rendition, uint32_t max_texels) override;
  void expectThroughput(double bps) override { loading_.ladder().expect(bps); }
  void judgeRendition(uint32_t sequence, uint32_t rendition, bool plays) override;
  void lookAhead(bool at_once) override;
  double clockTime() const override;
  std::optional<TimeRange> buffered(size_t number) const override;
  std::optional<SurfacePoint> surfacePoint(uint32_t vertex) const override;
  std::optional<uint32_t> vertexAt(const PinholeCamera& camera, double x_px, double y_px) const override;
  void sliceDecoding(const DecodeSlice& slice) override;
  void decodeElsewhere(bool on) override;
  std::optional<DecodeJob> decodeJob(size_t number) override;
  bool takeDecoded(uint32_t job, uint32_t row, std::span<const uint8_t> bytes, double seconds) override;
  const package::BaseMesh* mesh() const override;
  const package::ChunkMesh* chunkMesh() const override;
  void tick(double now_s) override;
  bool nextRequest(Request& out) override;
  void onRangeReceived(uint32_t id, std::span<const uint8_t> bytes) override;
  void onRangeFailed(uint32_t id, const std::string& reason) override;
  int acquireSlot(int decoder, int64_t timestamp_us) override;
  void uploadI420(int slot, const I420View& picture, PictureBytes bytes) override;
  gpu::TextureId slotTexture(int slot) const override;
  void commitSlot(int slot, int width = 0, int height = 0) override;
  double pace(int decoder) const override;
  void onDecoderFailed(int decoder, DecoderFault fault, const std::string& reason) override;
  void setInSight(bool in_sight) override;
  bool hasFrame() const override { return main().head.hasPicture(); }
  Result<render::Figure> figure() const override;
  bool makeNextProgram(const render::RecipeOptions& options) override;
  const package::Character* character() const override { return loading_.character(); }
  const package::Sequence* sequence() const override;
  uint32_t frame() const override;
  double currentTime() const override;
  bool seeking() const override { return main().head.seeking(); }
  bool failed() const override {
    return main().head.used() && loading_.broken(starting() ? 0 : main().head.sequence());
  }
  PlayerStats stats() const override;

 private:
  // player.cpp
  void noteCommand() { commanded_ = commanded_ || looks_ahead_ || hasFrame(); }
  void select(int sequence);
  void selectFirst(int sequence);
  bool starting() const { return main().head.used() && main().head.sequence() == loading_.startSequence(); }
  void leaveStart();
  void startAt(Track& track, int64_t frame);
  void glideParameters(double dt_s);
  bool fromCameras() const { return character()->appearance == package::AppearanceKind::Cameras; }
  bool loops(int sequence) const { return playback_.loops(loading_.sequence(sequence)); }
  bool loops(const Track& track) const { return loops(track.head.sequence()); }
  bool standsAtTheEnd() const;
  bool runs(const Track& track) const;     // its clock should advance
  bool isReady(const Track& track) const;  // mesh and header of its sequence are loaded
  const package::Sequence& wantedOf(const Track& track) const { return loading_.sequence(track.head.sequence()); }
  const package::Rendition& renditionOf(const Track& track, uint32_t number) const {  // of the requested sequence
    return wantedOf(track).renditions[number];
  }
  const package::Sequence& shownOf(const Track& track) const { return loading_.sequence(track.head.shown().sequence); }
  uint32_t frameOf(const Track& track, int64_t k) const;  // of the requested sequence
  uint32_t shownFrameOf(const Track& track) const;

  // player_loading.cpp
  void requestMissing();
  void settle(const Arrival& arrival);
  void fail(Error error, int broken_sequence);
  void giveUp(const Track& track, const Error& error);
  void fetchAhead();
  uint32_t landingOn(int target) const;

  // player_pictures.cpp
  FedSequence fedBy(const Track& track) const;
  void stopFeed(Track& track);
  bool previews(const Track& track) const;
  void restartFeed(Track& track);
  void feedAgain(Track& track);
  void closeTrack(Track& track);
  Track* trackOf(int& slot);
  bool checkSize(Track& track, int slot, int width, int height);
  bool checkNumber(Track& track, int slot, std::optional<uint32_t> seen);
  bool takeAs(Track& track, int slot, std::optional<uint32_t> seen);
  void settlePicture(int slot, std::optional<uint32_t> seen);

  // player_tick.cpp
  void decodeAhead();
  double clockRate(const Track& track) const;
  void choosePicture(Track& track);
  int nextChoice(const Track& track, int slot) const;
  void measureDecoding(const Track& track, bool late);
  bool showPicture(Track& track, int slot, const FrameGeometry& geometry);
  bool present(Track& track, int slot, const FrameGeometry& geometry);
  void finishSeek(Track& track, int previous_sequence);
  void finishAtEnd(Track& track);
  void sharpen();
  FrameGeometry geometryOf(int sequence, uint32_t frame, bool due);

  // player_transitions.cpp
  bool inPhase() const { return transitions_.phase() != Transitions::Phase::None; }
  void giveUpTransition() {
    if (inPhase()) later<&PlayerImpl::cancelTransition>(*this);
  }
  void goByGraph(int target);
  TransitionView transitionView() const;
  void beginTransition(int target);
  void stepTransition();
  void planTransition();
  void startFade();
  void stepFade();
  void takeOver();
  void cancelTransition();
  void selectInstead();
  void returnBeforeTheEnd();

  // player_figure.cpp
  void composeMesh();
  void stagePictures();
  const Positions* shownPositions() const;

  Track& main() { return tracks_[static_cast<size_t>(main_)]; }
  const Track& main() const { return tracks_[static_cast<size_t>(main_)]; }
  Track& other() { return tracks_[static_cast<size_t>(1 - main_)]; }
  const Track& other() const { return tracks_[static_cast<size_t>(1 - main_)]; }
  bool isMain(const Track& track) const { return &track == &main(); }

  PlayerOptions options_;
  Loading loading_;
  std::array<Track, kDecoders> tracks_;  // one per decoder
  int main_ = 0;                         // track of the current sequence
  Transitions transitions_;
  Parameters parameters_;
  std::string wanted_name_;  // selected before the manifest arrived
  bool in_sight_ = true;
  bool start_fades_ = false;  // Sharper was emitted for the picture after the start file's
  // Beginnings of other motions are fetched while both hold.
  bool looks_ahead_ = false;  // lookAhead was called
  bool commanded_ = false;    // a motion was selected since the first picture, or none has to be
  int misfits_ = 0;           // consecutive pictures with other frames' barcodes
};

}  // namespace fourdvt
