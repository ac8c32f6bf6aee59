// SPDX-License-Identifier: Apache-2.0
// Private to native/player: the state behind player.h. loading.cpp fetches, feeding.cpp decodes and fills picture
// slots, playback.cpp runs clocks and chooses frames, motion.cpp has parameters and root motion, transition.cpp leads
// from one state to another, figure.cpp composes what is drawn, events.cpp names events.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "motion/motion_graph.h"
#include "package/chunk_mesh.h"
#include "player/player.h"
#include "player/track.h"
#include "render/character_model.h"
#include "stream/gop_cache.h"

namespace fourdvt {

class PlayerImpl final : public Player {
 public:
  PlayerImpl(gpu::Device& device, const PlayerOptions& options, std::shared_ptr<render::Recipe> recipe);

  Status loadManifest(const FlatJson& gltf) override;
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
  bool inTransition() const override { return transition_.phase == Phase::Fading; }
  std::string goal() const override;
  void setTravel(bool on) override { travel_ = on; }
  void setPlacement(const motion::Placement& placement) override;
  motion::Placement placement() const override { return placement_; }
  void steer(double heading_rad) override;
  void setAlign(render::Align align) override { align_ = align; }
  void tick(double now_s) override;
  bool nextRequest(Request& out) override;
  bool nextEvent(Event& out) override;
  void onRangeReceived(uint32_t id, std::span<const uint8_t> bytes) override;
  void onRangeFailed(uint32_t id, const std::string& reason) override;
  int acquireSlot(int decoder, int64_t timestamp_us) override;
  void uploadI420(int slot, const I420View& picture) override;
  gpu::TextureId slotTexture(int slot) const override;
  void commitSlot(int slot) override;
  void onDecoderFailed(int decoder, const std::string& reason) override;
  bool hasFrame() const override { return main().shown.slot >= 0; }
  Result<render::Figure> figure() const override;
  render::Align align() const override { return align_; }
  Status draw(const render::View& view, const render::RecipeOptions& options, gpu::TargetId target) override;
  const package::Character* character() const override { return character_ ? &*character_ : nullptr; }
  const package::Sequence* sequence() const override;
  uint32_t frame() const override;
  double currentTime() const override;
  bool paused() const override { return !playing_; }
  bool seeking() const override { return main().seeking; }
  PlayerStats stats() const override;

 private:
  enum class PartKind { Mesh, Graph, Header, Video, Chunk };
  struct Fetch {
    PartKind kind;
    int sequence;
    uint32_t gop;
    int tries;
    FetchRange range;
  };
  struct SequenceState {
    stream::PartState header = stream::PartState::Absent;
    package::StreamIndex index;
    bool broken = false;  // reported once; nothing more is asked for
  };
  // Wanted: waits for graph and header. Preparing: the second track waits at its first frame for the source to reach
  // `begin_k`. Fading: both play.
  enum class Phase { None, Wanted, Preparing, Fading };
  struct TransitionState {
    Phase phase = Phase::None;
    int target = -1;
    glm::vec3 shift{0};        // target's character frame seen from the source's
    int64_t begin_k = 0;       // source presentation at which the fade begins
    int64_t start_k = 0;       // the target's then
    uint32_t fade_frames = 0;  // of the target
    float fade = 0;            // 0…1
    double wanted_since_s = 0, prepared_since_s = 0;
    bool measured = false;  // lead_s_ knows how long this preparation took
  };

  // loading.cpp
  void requestFetch(PartKind kind, int sequence, uint32_t gop, const std::string& uri, uint64_t offset, uint64_t bytes);
  void requestMissing();
  void requestTrack(const Track& track);
  void requestHeader(int sequence);
  void requestGraph();
  void requestGop(int sequence, uint32_t gop);
  Status receiveMesh(std::span<const uint8_t> bytes);
  Status receiveHeader(int sequence, std::span<const uint8_t> bytes);
  void receiveGraph(std::span<const uint8_t> bytes);
  bool ready(const Track& track) const;  // model and header of its sequence are there
  const package::ChunkFrames* geometryOf(int sequence, uint32_t frame);
  void fail(Error error, int broken_sequence);
  void reportProgress(uint64_t more_bytes);
  void addNeededGops(const Track& track, std::vector<stream::GopKey>& keys) const;

  // feeding.cpp
  void stopFeed(Track& track);
  void restartFeed(Track& track);
  bool feedNext(Track& track, Request& out);  // one request of the decoder's, when it may have one
  void finishGop(Track& track);
  Status preparePicture(const Track& track, Slot& slot);
  void closeTrack(Track& track);
  Slot* slotAt(int slot, Track*& track);

  // playback.cpp
  void startAt(Track& track, int64_t frame);
  void select(int sequence);
  int findSequence(const std::string& name) const;
  bool looping(int sequence) const;
  bool looping(const Track& track) const { return looping(track.sequence); }
  bool runs(const Track& track) const;  // its clock should
  uint32_t frameOf(const Track& track, int64_t k) const;
  const package::Sequence& sequenceAt(int index) const { return character_->sequences[static_cast<size_t>(index)]; }
  const package::Sequence& wantedOf(const Track& track) const { return sequenceAt(track.sequence); }
  const SequenceState& stateOf(const Track& track) const { return sequences_[static_cast<size_t>(track.sequence)]; }
  int64_t positionOf(const Track& track) const;
  void choosePicture(Track& track);
  void finishAtEnd(Track& track);
  void finishSeek(Track& track, int previous_sequence);
  void noteStarvation(bool starved);
  void emit(EventKind kind) { events_.push_back({kind, {}, 0, 0}); }

  // motion.cpp
  double clockRate(const Track& track) const;
  void enterParameters(Track& track, int sequence);
  double wantedParameter(int sequence, size_t parameter) const;
  void glideParameters(double dt_s);
  void turn(double dt_s);
  void takeRoots(Track& track, const package::ChunkFrames& frames, uint32_t row, int64_t k, bool follows);
  void travel(const Track& track, const glm::vec3& step);
  motion::Placement sourcePlacement() const;
  void setSourcePlacement(const motion::Placement& placement);

  // transition.cpp
  void beginTransition(int target);
  void stepTransition();
  void planTransition();
  void startFade();
  void stepFade();
  void takeOver();
  void cancelTransition();
  void selectInstead();
  void returnBeforeTheEnd();

  // figure.cpp
  bool present(Track& track, int slot);
  bool blend(Track& track);
  void composeMesh();

  Track& main() { return tracks_[static_cast<size_t>(main_)]; }
  const Track& main() const { return tracks_[static_cast<size_t>(main_)]; }
  Track& other() { return tracks_[static_cast<size_t>(1 - main_)]; }
  const Track& other() const { return tracks_[static_cast<size_t>(1 - main_)]; }

  gpu::Device& device_;
  PlayerOptions options_;
  std::shared_ptr<render::Recipe> recipe_;
  std::optional<package::Character> character_;
  std::optional<package::BaseMesh> mesh_;
  package::ChunkMesh chunk_mesh_;
  std::optional<render::CharacterModel> model_;
  std::optional<motion::MotionGraph> graph_;
  stream::PartState mesh_state_ = stream::PartState::Absent, graph_state_ = stream::PartState::Absent;
  std::vector<SequenceState> sequences_;
  stream::GopCache cache_;
  std::string wanted_name_;  // selected before the manifest arrived

  std::map<uint32_t, Fetch> fetches_;
  uint32_t next_fetch_id_ = 1;
  std::deque<Request> requests_;  // without DecodeSample and ConfigureDecoder: those are made when polled
  std::deque<Event> events_;

  std::array<Track, kDecoders> tracks_;
  int main_ = 0;  // the track whose sequence is the current one
  TransitionState transition_;
  int goal_ = -1;         // state asked for last
  int return_to_ = -1;    // state that led to the current one, which does not loop
  double asked_s_ = 0;    // when it was asked for: the tick before; later, where it could not play since
  double lead_s_ = 0.12;  // what preparing a transition takes

  bool playing_ = false, waiting_ = false, can_play_ = false, seek_requested_ = false;
  int loop_override_ = -1;
  double rate_ = 1;
  double now_s_ = 0, tick_s_ = 0, last_timeupdate_s_ = -1, starved_since_s_ = -1;
  bool ticked_ = false;

  std::map<std::string, double> parameters_;  // wanted
  motion::Placement placement_;
  std::optional<double> wanted_heading_rad_;
  bool travel_ = false;
  render::Align align_ = render::Align::Baked;

  bool compose_ = false;              // the mesh drawn is not that of the tracks
  Positions faded_;                   // scratch
  std::vector<glm::vec2> alignment_;  // scratch
  mutable std::array<render::Look, 2> looks_;
  PlayerStats stats_;
  uint64_t progress_loaded_ = 0, progress_total_ = 0;
};

}  // namespace fourdvt
