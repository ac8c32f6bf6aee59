// SPDX-License-Identifier: Apache-2.0
// Loaded parts of a character: manifest, base mesh, motion graph, stream headers, and the GOPs that playback needs,
// within a budget of encoded bytes. Requests missing parts, checks responses against the manifest, decodes geometry on
// demand. The player supplies its tracks' needs, and marks a sequence as broken on a returned error.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motion/motion_graph.h"
#include "package/chunk_mesh.h"
#include "player/parts/figure.h"
#include "player/parts/gop_cache.h"
#include "player/parts/ladder.h"
#include "player/parts/messages.h"

namespace fourdvt {

// Limits of geometry decoding per tick; see Player::sliceDecoding.
struct DecodeSlice {
  uint32_t steps = 1;           // at least 1; a step: one part of a row, or a whole row from cameras
  double seconds = 0;           // no further step begins after this; 3 to 8 times as long while seeking
  double (*now_s)() = nullptr;  // null: limit by steps alone
};

// Totals of geometry decoding. Times, and timed rows, require DecodeSlice::now_s; longest_tick_s covers local decoding
// only.
struct DecodeStats {
  uint64_t rows = 0, timed_rows = 0, elsewhere = 0;  // elsewhere: subset of `rows` from Loading::takeDecoded
  double seconds = 0, longest_tick_s = 0;
  double rowSeconds() const { return timed_rows ? seconds / static_cast<double>(timed_rows) : 0; }
};

// Decode job of a layered character's GOP for another thread, with Loading::chunkMesh.
struct DecodeJob {
  uint32_t id = 0;                 // unique per player, never 0
  std::span<const uint8_t> chunk;  // valid until the next call of the player
  const package::StreamIndex* index = nullptr;
  uint32_t gop = 0;
  uint32_t frames = 0;  // leading frames needed by now
};

// Needs of a track from its position on.
struct Need {
  int sequence = -1;
  uint32_t frame = 0;  // shown or sought frame
  bool loops = false;
  std::optional<uint32_t> fed_gop;  // GOP being fed to the decoder; may be ahead of the frame
  bool stands = false;              // paused frame with a picture already on screen
};

// Result of a completed or failed fetch.
struct Arrival {
  enum class What { Nothing, Mesh, Header, Other, LeftOut } what = What::Nothing;
  int sequence = -1;
  // Not ok: the sequence (-1: the whole character) is broken; with What::LeftOut only one of its renditions.
  Status status;
};

class Loading {
 public:
  // rendition: as Ladder::setQuality.
  Loading(Outbox& outbox, uint64_t encoded_budget_bytes, uint32_t rendition = kHighestRendition)
      : ladder_(rendition), budget_bytes_(encoded_budget_bytes), cache_(encoded_budget_bytes), fetches_(outbox) {}

  // start: bytes of the character's start file; ignored if its hash differs from the manifest's. On errors, those of
  // package::readManifest, the previous state is kept.
  Status readManifest(const FlatJson& gltf, std::span<const uint8_t> start = {});
  const package::Character* character() const {
    return character_ ? &*character_ : nullptr;
  }  // null before readManifest
  int sequenceCount() const { return static_cast<int>(character_ ? character_->sequences.size() : 0); }
  // Sequence of the manifest. With a start file, `index` may also be startSequence: frame 0 of the first sequence.
  const package::Sequence& sequence(int index) const {
    return index < sequenceCount() ? character_->sequences[static_cast<size_t>(index)] : start_;
  }
  int startSequence() const { return started_ ? sequenceCount() : -1; }
  bool hasMesh() const { return mesh_.has_value(); }
  // Rendition of the GOP's samples, loaded or requested.
  uint32_t renditionOf(int sequence, uint32_t gop) const;
  Ladder& ladder() { return ladder_; }
  // Drops samples, loaded or in flight, in renditions other than the ladder's present choice; they are fetched anew.
  void dropOtherRenditions();
  int find(const std::string& name) const;                  // -1: no sequence of that name
  const package::BaseMesh& mesh() const { return *mesh_; }  // requires Arrival::What::Mesh
  bool hasHeader(int sequence) const { return stream(sequence).header == PartState::Present; }
  bool broken(int sequence) const { return stream(sequence).broken; }
  bool playable(int sequence) const { return hasHeader(sequence) && !broken(sequence); }
  const package::StreamIndex& index(int sequence) const { return stream(sequence).index; }  // requires its header
  const motion::MotionGraph* graph() const { return graph_ ? &*graph_ : nullptr; }          // null: not loaded
  // True without a motion graph: none in the manifest, or its fetch failed.
  bool lacksGraph() const { return !graph_allowed_ || character_->graph_uri.empty() || graphFailed(); }
  void allowGraph(bool allowed) { graph_allowed_ = allowed; }  // default: allowed
  bool graphFailed() const { return graph_state_ == PartState::Failed; }

  // Requests missing parts of the needs, most urgent first: mesh, header and GOPs of each need in turn, then the header
  // of `next_sequence` (-1: none). Evicts unneeded GOPs above the budget.
  void requestMissing(std::span<const Need> needs, int next_sequence);
  // Entry into another sequence.
  struct Landing {
    int sequence = -1;
    uint32_t frame = 0;
  };
  void lookAhead() { looks_ahead_ = true; }  // enables fetchAhead
  // Requests, while the network is idle, a missing part of the first incomplete landing: its header, or its GOP in the
  // lowest rendition. An urgent need cancels it. Requires the automatic choice of renditions.
  void fetchAhead(std::span<const Landing> landings);
  bool idle() const { return fetches_.empty(); }
  void requestGraph();
  // Compares the shown frame's rendition with the GOP's: true if feeding the GOP anew yields a higher one. The matching
  // geometry is then used as well.
  bool takeSharper(int sequence, uint32_t gop, uint32_t rendition);
  void onFirstPicture() { fetches_.endProgress(); }  // the motion graph may be fetched from now on
  Arrival receive(uint32_t id, std::span<const uint8_t> bytes);
  Arrival refuse(uint32_t id, const std::string& reason);
  // Stops requests for a sequence (-1: all) until revive. False: it was broken before.
  bool markBroken(int sequence);
  // Requests failed parts of a sequence, and shared parts, again. False: the sequence was not broken.
  bool revive(int sequence);

  // The GOP's samples, contiguous as in the file; null: not loaded.
  const std::vector<uint8_t>* video(int sequence, uint32_t gop) const;
  bool holds(int sequence, uint32_t gop) const;  // samples and geometry loaded
  // Switches `video` to the better rendition if that is loaded; call before the GOP's first sample is fed.
  void takeBetter(int sequence, uint32_t gop);
  // Measures throughput, once per tick, from the bytes received since the last one.
  void tick(double step_s);
  // Enables slicing: decodeAhead decodes in place of `geometry`.
  void sliceDecoding(const DecodeSlice& slice) { slice_ = slice; }
  bool slicing() const { return slice_.has_value(); }
  // Decodes within the limits of a tick: up to each need's frame, then what follows, nearest first.
  void decodeAhead(std::span<const Need> needs, bool seeking);
  // On: decodeAhead turns layered characters' GOPs into jobs, except one that was begun here and is due. Off: partly
  // decoded GOPs are decoded here from their first row. Requires sliceDecoding.
  void decodeElsewhere(bool on) { elsewhere_ = on; }
  // Jobs since the last decodeAhead, most urgent first; nullopt beyond the last one.
  std::optional<DecodeJob> decodeJob(size_t number);
  // Takes a row decoded elsewhere, and its decoding time; empty bytes: the row failed there and is retried here. Rows
  // of a job come in order, restarting at the first after a while without need; out-of-order rows are ignored. False:
  // the job is no longer needed.
  bool takeDecoded(uint32_t job, uint32_t row, std::span<const uint8_t> bytes, double seconds);
  const package::ChunkMesh& chunkMesh() const { return chunk_mesh_; }  // built from `mesh`
  const DecodeStats& decodeStats() const { return decoded_; }
  // Decodes up to this frame; in slices only a due row and the next one. `out` stays empty until the frame is decoded.
  // Errors: StreamInvalid.
  Status geometry(int sequence, uint32_t frame, bool due, FrameGeometry& out);
  uint64_t bytesFetched() const { return fetches_.bytesFetched(); }
  uint64_t encodedBytesHeld() const { return cache_.encodedBytes(); }

 private:
  struct Stream {  // one per sequence
    PartState header = PartState::Absent;
    package::StreamIndex index, coarse;  // coarse: index of the coarse chunks, if any
    bool broken = false;
    uint32_t rendition = 0;     // last choice
    bool failed_ahead = false;  // ahead fetch failed: retry only on a need
  };

  Stream& stream(int sequence) { return streams_[static_cast<size_t>(sequence)]; }
  const Stream& stream(int sequence) const { return streams_[static_cast<size_t>(sequence)]; }
  void requestMesh();
  void requestHeader(int sequence);
  bool requestGop(GopKey key, double ahead_s, bool stands = false);
  uint32_t choose(GopKey key, double ahead_s, bool stands) const;
  uint32_t chooseStill(GopKey key) const;
  void requestChunk(GopKey key, FetchPurpose::Kind kind, const package::ChunkEntry& entry);
  void requestFine(GopKey key, Gop& gop);
  void takeFine(Gop& gop);
  void enter(Gop& gop, uint32_t row);
  Status open(GopKey key, Gop& gop);
  static constexpr int kGopsOnTheirWay = 2;
  static constexpr uint32_t kStep = UINT32_MAX;
  Status decode(GopKey key, Gop& gop, uint32_t row);
  struct SliceLeft;
  struct Ahead {
    GopKey key;
    Gop* gop = nullptr;
    uint32_t row = 0, row_count = 0;
  };
  Ahead reach(const Need& need, uint32_t ahead);
  bool decodeAhead(const Ahead& at, bool urgent, SliceLeft& left);
  void handOver(const Ahead& at);
  void giveAway(const Ahead& at, bool urgent);
  // Index that contains the GOP's chunk, fine or coarse.
  const package::StreamIndex& indexOf(GopKey key, const Gop& gop) const;
  void requestAhead(GopKey key);
  void settleAhead(std::span<const Need> needs, int next_sequence, const std::vector<GopKey>& keep);
  void keepAhead(std::vector<GopKey>& keep);
  uint64_t bytesOf(const std::vector<GopKey>& keys) const;
  void requestVideo(GopKey key, FetchPurpose::Kind kind, uint32_t rendition);
  void raise(const std::vector<GopKey>& keys, bool stands);
  uint32_t raised(int sequence, uint32_t from) const;
  void cancelRaises();
  void lower(const std::vector<GopKey>& keys);
  bool holdsWhole(int sequence) const;
  void cancelUnneeded(const std::vector<GopKey>& keep);
  void addNeededGops(const Need& need, std::vector<GopKey>& keys) const;
  uint64_t hashOf(const FetchPurpose& purpose) const;
  uint32_t renditionOf(const FetchPurpose& purpose) const;
  Arrival lose(const FetchPurpose& purpose, Error error);
  PartState* stateOf(const FetchPurpose& purpose);
  Status receiveMesh(std::span<const uint8_t> bytes);
  Status takeMesh(Result<package::BaseMesh> mesh);
  Status takeStart(std::span<const uint8_t> bytes);
  Status receiveHeader(int sequence, std::span<const uint8_t> bytes);
  Status checkHeader(const package::Sequence& sequence, const package::StreamIndex& index) const;
  void receiveGraph(std::span<const uint8_t> bytes);
  void receiveGop(const FetchPurpose& purpose, std::span<const uint8_t> bytes);

  bool fromCameras() const { return character_->appearance == package::AppearanceKind::Cameras; }

  Ladder ladder_;
  uint64_t bytes_before_ = 0;  // bytesFetched at the last tick
  std::optional<package::Character> character_;
  std::optional<package::BaseMesh> mesh_;
  package::ChunkMesh chunk_mesh_;
  std::optional<motion::MotionGraph> graph_;
  bool graph_allowed_ = true;
  PartState mesh_state_ = PartState::Absent, graph_state_ = PartState::Absent;
  std::vector<Stream> streams_;
  package::Sequence start_;
  bool started_ = false;
  bool looks_ahead_ = false;   // fetchAhead enabled
  std::vector<GopKey> ahead_;  // beginnings of likely next sequences
  uint64_t budget_bytes_, needed_bytes_ = 0;
  GopCache cache_;
  std::optional<DecodeSlice> slice_;  // nullopt: a frame's rows are decoded when it is due
  DecodeStats decoded_;
  struct Job {
    uint32_t id;
    GopKey key;
    uint32_t frames;
  };
  bool elsewhere_ = false;
  std::vector<Job> jobs_;
  uint32_t last_job_ = 0;
  double tick_s_ = 0, tick_decode_s_ = 0;  // duration since the previous tick; decoding time in this tick
  Fetches fetches_;
};

}  // namespace fourdvt
