// SPDX-License-Identifier: Apache-2.0
// Loaded parts of a character: manifest, base mesh, motion graph, stream headers, and the GOPs that playback needs,
// within a budget of encoded bytes. Asks for what is missing, checks what arrives against the manifest, decodes
// geometry when it is asked for. Does NOT decide what is played: the player tells it what its tracks need. Does NOT
// report errors as events: a call returns them, and the player marks the sequence as broken.
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

// Limits of what is decoded of geometry in one tick; see Player::sliceDecoding.
struct DecodeSlice {
  uint32_t steps = 1;           // at least 1; parts of rows of layered characters, whole rows of others
  double seconds = 0;           // after so long no further one is begun, 3 to 8 times that while a frame is sought
  double (*now_s)() = nullptr;  // null: steps alone count
};

// Geometry decoded since the beginning. Times, and the rows that they are of, are counted with DecodeSlice::now_s only;
// longest_tick_s is of what is decoded here.
struct DecodeStats {
  uint64_t rows = 0, timed_rows = 0, elsewhere = 0;  // elsewhere: of `rows`, Loading::takeDecoded
  double seconds = 0, longest_tick_s = 0;
  double rowSeconds() const { return timed_rows ? seconds / static_cast<double>(timed_rows) : 0; }
};

// A GOP of a layered character that is to be decoded elsewhere, with Loading::chunkMesh.
struct DecodeJob {
  uint32_t id = 0;                 // of these bytes in this player; never repeats, never 0
  std::span<const uint8_t> chunk;  // valid until the next call of the player
  const package::StreamIndex* index = nullptr;
  uint32_t gop = 0;
  uint32_t frames = 0;  // so many of its first are wanted by now
};

// Needs of a track that plays on.
struct Need {
  int sequence = -1;
  uint32_t frame = 0;  // that is shown or sought
  bool loops = false;
  std::optional<uint32_t> fed_gop;  // whose samples are going to the decoder; it may be ahead of the frame
  bool stands = false;              // the frame stays, and something of it is on screen already
};

// Outcome of an answer to a fetch.
struct Arrival {
  enum class What { Nothing, Mesh, Header, Other, LeftOut } what = What::Nothing;
  int sequence = -1;
  // Not ok: the sequence is broken, or with -1 the whole character; LeftOut: only a rendition of it is.
  Status status;
};

class Loading {
 public:
  // rendition: as Ladder::setQuality takes it.
  Loading(Outbox& outbox, uint64_t encoded_budget_bytes, uint32_t rendition = kHighestRendition)
      : ladder_(rendition), budget_bytes_(encoded_budget_bytes), cache_(encoded_budget_bytes), fetches_(outbox) {}

  // start: the bytes of the character's start file; not used if they are not those that the manifest's hash is of.
  // Errors: as of package::readManifest. What was there stays.
  Status readManifest(const FlatJson& gltf, std::span<const uint8_t> start = {});
  const package::Character* character() const { return character_ ? &*character_ : nullptr; }  // null: no manifest yet
  int sequenceCount() const { return static_cast<int>(character_ ? character_->sequences.size() : 0); }
  // The manifest's sequences, and with a start file one more (startSequence): frame 0 of the first.
  const package::Sequence& sequence(int index) const {
    return index < sequenceCount() ? character_->sequences[static_cast<size_t>(index)] : start_;
  }
  int startSequence() const { return started_ ? sequenceCount() : -1; }
  bool hasMesh() const { return mesh_.has_value(); }
  // Rendition that the GOP's samples are of, or will be.
  uint32_t renditionOf(int sequence, uint32_t gop) const;
  Ladder& ladder() { return ladder_; }
  // Samples in another rendition than the ladder chooses now, and those on their way, are fetched anew.
  void dropOtherRenditions();
  int find(const std::string& name) const;                  // -1: there is no sequence of that name
  const package::BaseMesh& mesh() const { return *mesh_; }  // after Arrival::What::Mesh
  bool hasHeader(int sequence) const { return stream(sequence).header == PartState::Present; }
  bool broken(int sequence) const { return stream(sequence).broken; }
  bool playable(int sequence) const { return hasHeader(sequence) && !broken(sequence); }
  const package::StreamIndex& index(int sequence) const { return stream(sequence).index; }  // once it has its header
  const motion::MotionGraph* graph() const { return graph_ ? &*graph_ : nullptr; }          // null: not there
  // The manifest names no motion graph, or it could not be had.
  bool lacksGraph() const { return !graph_allowed_ || character_->graph_uri.empty() || graphFailed(); }
  void allowGraph(bool allowed) { graph_allowed_ = allowed; }  // at first it is
  bool graphFailed() const { return graph_state_ == PartState::Failed; }

  // Asks for what the needs lack, the most urgent first: mesh, header and GOPs of each need in turn, then the header of
  // `next_sequence` (-1: none). Frees what nobody needs when the budget is exceeded.
  void requestMissing(std::span<const Need> needs, int next_sequence);
  // Entry into another sequence.
  struct Landing {
    int sequence = -1;
    uint32_t frame = 0;
  };
  void lookAhead() { looks_ahead_ = true; }  // fetchAhead may be called from now on
  // Requests, if nothing is on its way, a part of the first landing that lacks one: its header, or its GOP in the
  // lowest rendition. A need that is due soon calls it off. With an automatic choice of renditions only.
  void fetchAhead(std::span<const Landing> landings);
  bool idle() const { return fetches_.empty(); }
  void requestGraph();
  // The shown frame of a GOP stands in this rendition: true if feeding the GOP anew brings a higher one, and then with
  // it the geometry that belongs to it.
  bool takeSharper(int sequence, uint32_t gop, uint32_t rendition);
  void onFirstPicture() { fetches_.endProgress(); }  // the motion graph may be fetched now
  Arrival receive(uint32_t id, std::span<const uint8_t> bytes);
  Arrival refuse(uint32_t id, const std::string& reason);
  // Nothing more is asked for of a sequence, or with -1 of any, until it is revived. False: that was known.
  bool markBroken(int sequence);
  // Failed parts of a sequence, and of what all need, are asked for again. False: the sequence was not broken.
  bool revive(int sequence);

  // The GOP's samples, contiguous as in the file; null: not there.
  const std::vector<uint8_t>* video(int sequence, uint32_t gop) const;
  bool holds(int sequence, uint32_t gop) const;  // its samples and its geometry
  // Before the GOP's first sample is fed: from now on `video` is of the better rendition, if that is there.
  void takeBetter(int sequence, uint32_t gop);
  // Once a tick: measures the throughput by the bytes that came since the last one.
  void tick(double step_s);
  // From now on decodeAhead decodes what `geometry` does not.
  void sliceDecoding(const DecodeSlice& slice) { slice_ = slice; }
  bool slicing() const { return slice_.has_value(); }
  // Decodes within the limits of a tick: as far as each need's frame, then what follows it, nearest first.
  void decodeAhead(std::span<const Need> needs, bool seeking);
  // On: of layered characters decodeAhead decodes only a GOP that it has begun and that is due; the others become jobs.
  // Off: what is not decoded whole is decoded here, from its first row. Needs sliceDecoding.
  void decodeElsewhere(bool on) { elsewhere_ = on; }
  // The jobs since the last decodeAhead, the most urgent first. None: there is no job of that number.
  std::optional<DecodeJob> decodeJob(size_t number);
  // Takes a row that was decoded elsewhere, and the time that it took; without bytes the row does not decode there, and
  // is tried here. Rows of a job come in order, from the first again after a while in which it was not wanted; others
  // than the next one are ignored. False: the job is no longer wanted.
  bool takeDecoded(uint32_t job, uint32_t row, std::span<const uint8_t> bytes, double seconds);
  const package::ChunkMesh& chunkMesh() const { return chunk_mesh_; }  // of `mesh`
  const DecodeStats& decodeStats() const { return decoded_; }
  // Decodes as far as this frame; in slices only a row that is due and the next one. `out` stays empty while the frame
  // is not there.
  // Errors: StreamInvalid.
  Status geometry(int sequence, uint32_t frame, bool due, FrameGeometry& out);
  uint64_t bytesFetched() const { return fetches_.bytesFetched(); }
  uint64_t encodedBytesHeld() const { return cache_.encodedBytes(); }

 private:
  struct Stream {  // one of each sequence
    PartState header = PartState::Absent;
    package::StreamIndex index, coarse;  // coarse: of those chunks, if there are any
    bool broken = false;
    uint32_t rendition = 0;     // that was chosen last
    bool failed_ahead = false;  // only a need asks for it again
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
  // Index of the chunks that the GOP's is one of.
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
  bool looks_ahead_ = false;   // fetchAhead may be called
  std::vector<GopKey> ahead_;  // beginnings, of some sequences that may be next
  uint64_t budget_bytes_, needed_bytes_ = 0;
  GopCache cache_;
  std::optional<DecodeSlice> slice_;  // none: what a frame needs is decoded at once
  DecodeStats decoded_;
  struct Job {
    uint32_t id;
    GopKey key;
    uint32_t frames;
  };
  bool elsewhere_ = false;
  std::vector<Job> jobs_;
  uint32_t last_job_ = 0;
  double tick_s_ = 0, tick_decode_s_ = 0;  // since the tick before; time of decoding in this tick
  Fetches fetches_;
};

}  // namespace fourdvt
