// SPDX-License-Identifier: Apache-2.0
// Private to native/player: the state behind player.h. loading.cpp fetches, feeding.cpp decodes and fills picture
// slots, playback.cpp runs the clock, chooses frames and draws, events.cpp names events.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "package/chunk_mesh.h"
#include "player/player.h"
#include "render/character_model.h"
#include "stream/clock.h"
#include "stream/gop_cache.h"

namespace fourdvt {

class PlayerImpl final : public Player {
 public:
  PlayerImpl(gpu::Device& device, const PlayerOptions& options, std::unique_ptr<render::Recipe> recipe);

  Status loadManifest(const FlatJson& gltf) override;
  void play() override;
  void pause() override;
  void seekFrame(uint32_t frame) override;
  void seek(double time_s) override;
  Status selectSequence(const std::string& name) override;
  void setRate(double rate) override;
  void setLoop(int loop) override;
  void tick(double now_s) override;
  bool nextRequest(Request& out) override;
  bool nextEvent(Event& out) override;
  void onRangeReceived(uint32_t id, std::span<const uint8_t> bytes) override;
  void onRangeFailed(uint32_t id, const std::string& reason) override;
  int acquireSlot(int64_t timestamp_us) override;
  void uploadI420(int slot, const I420View& picture) override;
  gpu::TextureId slotTexture(int slot) const override;
  void commitSlot(int slot) override;
  void onDecoderFailed(const std::string& reason) override;
  bool hasFrame() const override { return shown_.slot >= 0; }
  Status draw(const render::View& view, const render::RecipeOptions& options, gpu::TargetId target) override;
  const package::Character* character() const override { return character_ ? &*character_ : nullptr; }
  const package::Sequence* sequence() const override;
  uint32_t frame() const override;
  double currentTime() const override;
  bool paused() const override { return !playing_; }
  bool seeking() const override { return seeking_; }
  PlayerStats stats() const override;

 private:
  enum class PartKind { Mesh, Header, Video, Chunk };
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
  struct Slot {
    enum class State { Free, Filling, Ready } state = State::Free;
    int sequence = -1;
    int64_t k = 0;       // presentation: frames since the sequence's start, unwrapped over loops
    uint32_t epoch = 0;  // feed restart it belongs to
    bool wrong_frame = false;
    int width = 0, height = 0;
    render::PictureTextures picture;
  };
  struct Shown {
    int slot = -1;
    int sequence = -1;
    int64_t k = 0;
  };

  // loading.cpp
  void requestFetch(PartKind kind, int sequence, uint32_t gop, const std::string& uri, uint64_t offset, uint64_t bytes);
  void requestMissing();
  void requestGop(int sequence, uint32_t gop);
  Status receiveMesh(std::span<const uint8_t> bytes);
  Status receiveHeader(int sequence, std::span<const uint8_t> bytes);
  bool ready() const;  // model and header of the active sequence are there
  const package::ChunkFrames* geometryOf(int sequence, uint32_t frame);
  void fail(Error error, int broken_sequence);
  void reportProgress(uint64_t more_bytes);
  std::vector<stream::GopKey> keptGops() const;

  // feeding.cpp
  void stopFeed();
  void restartFeed();
  bool feedNext(Request& out);  // one request of the decoder's, when it may have one
  void finishGop();
  size_t usedSlots() const;
  Status preparePicture(Slot& slot);

  // playback.cpp
  void startAt(uint32_t frame);
  bool looping() const;
  uint32_t frameOf(int64_t k) const;
  const package::Sequence& active() const { return character_->sequences[static_cast<size_t>(active_)]; }
  uint32_t frameCount() const { return active().frame_count; }
  double fps() const { return active().fps; }
  int pictureFor(int64_t newest_k) const;
  void present(int slot);
  void finishSeek(int previous_sequence);
  void choosePicture();
  void noteStarvation(bool starved);
  void emit(EventKind kind) { events_.push_back({kind, {}, 0, 0}); }

  gpu::Device& device_;
  PlayerOptions options_;
  std::unique_ptr<render::Recipe> recipe_;
  std::optional<package::Character> character_;
  std::optional<package::BaseMesh> mesh_;
  package::ChunkMesh chunk_mesh_;
  std::optional<render::CharacterModel> model_;
  stream::PartState mesh_state_ = stream::PartState::Absent;
  std::vector<SequenceState> sequences_;
  stream::GopCache cache_;
  int active_ = -1;          // sequence wanted
  std::string wanted_name_;  // selected before the manifest arrived

  std::map<uint32_t, Fetch> fetches_;
  uint32_t next_fetch_id_ = 1;
  std::deque<Request> requests_;  // without DecodeSample and ConfigureDecoder: those are made when polled
  std::deque<Event> events_;

  // Feeding: samples go out in decoding order from a GOP's start; pictures before `drop_before_k_` are not shown.
  bool feeding_ = false, configured_ = false, flushed_ = false;
  int configured_sequence_ = -1;
  uint32_t epoch_ = 0;
  int64_t feed_gop_k_ = 0;  // presentation of the first frame of the GOP being fed
  uint32_t feed_gop_ = 0, feed_sample_ = 0;
  bool feed_done_ = false;  // a sequence that does not loop is fed to its end
  int64_t drop_before_k_ = 0;
  int64_t serial_base_ = 0, next_serial_ = 0;
  std::map<int64_t, int64_t> in_flight_;  // timestamp → k
  size_t reorder_allowance_ = 4;          // samples the decoder may hold beyond the slots; grows if it holds more
  int ticks_without_output_ = 0;
  std::vector<Slot> slots_;

  stream::PlaybackClock clock_;
  bool playing_ = false, seeking_ = true, waiting_ = false, can_play_ = false;
  bool ended_ = false, seek_requested_ = false;
  int loop_override_ = -1;
  int64_t wanted_k_ = 0;  // while seeking or paused
  Shown shown_;
  double now_s_ = 0, last_timeupdate_s_ = -1, starved_since_s_ = -1;
  Positions positions_;  // scratch
  PlayerStats stats_;
  uint64_t progress_loaded_ = 0, progress_total_ = 0;
};

}  // namespace fourdvt
