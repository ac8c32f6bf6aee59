// SPDX-License-Identifier: Apache-2.0
#include "player/parts/loading.h"

#include <algorithm>

#include "base/hash.h"
#include "base/later.h"
#include "package/mesh_code.h"
#include "package/start_file.h"

namespace fourdvt {

using Kind = FetchPurpose::Kind;

namespace {

constexpr int kMaxAhead = 4;            // GOPs per sequence: every landing frame of a short loop
constexpr size_t kSoonGops = 2;         // nearest GOPs of a need
constexpr uint64_t kBudgetDivisor = 2;  // share of the budget for needs and beginnings
constexpr double kAhead_s = 6;          // held or in flight
// More would compete with the first one for bandwidth.
constexpr int kGopsBeforeTheFirstPicture = 1;

}  // namespace

Status Loading::readManifest(const FlatJson& gltf, std::span<const uint8_t> start) {
  auto read = package::readManifest(gltf);
  if (!read.ok()) return read.error();
  character_ = read.take();
  ladder_.forget();
  streams_.clear();
  streams_.resize(character_->sequences.size());
  if (fromCameras()) mesh_state_ = PartState::Present;  // every GOP has meshes of its own
  const package::Start& s = character_->start;
  started_ = start.size() == s.bytes && !s.uri.empty() && fnv1a(start) == s.hash && takeStart(start).ok();
  fetches_.startProgress(mesh_state_ == PartState::Present ? 0 : character_->mesh_bytes);
  return {};
}

// Makes startSequence, frame 0 of the first sequence with its one GOP complete, from the start file.
Status Loading::takeStart(std::span<const uint8_t> bytes) {
  FOURDVT_ASSIGN(package::StartFile file, package::readStartFile(bytes));
  start_ = character_->sequences[0];
  start_.frame_count = 1;
  start_.renditions.resize(1);
  start_.coarse_renditions = 0;
  start_.stream_bytes = start_.renditions[0].video_bytes = bytes.size();
  FOURDVT_TRY(checkHeader(start_, file.index));
  if (!fromCameras())
    FOURDVT_TRY(takeMesh(package::decodeMeshCode(file.mesh, character_->vertex_count, character_->face_count)));
  const package::Sequence& first = character_->sequences[0];
  if (file.header.size() == first.stream_header_bytes && fnv1a(file.header) == first.stream_header_hash)
    FOURDVT_TRY(receiveHeader(0, file.header));
  streams_.resize(streams_.size() + 1);
  streams_.back().header = PartState::Present;
  streams_.back().index = std::move(file.index);
  Gop& gop = cache_.touch({sequenceCount(), 0});
  gop.chunk = std::move(file.chunk);
  gop.video = std::move(file.video);
  gop.chunk_state = gop.video_state = PartState::Present;
  return {};
}

void Loading::tick(double step_s) {
  ladder_.measure(bytesFetched() - bytes_before_, step_s, !fetches_.empty());
  bytes_before_ = bytesFetched();
  tick_s_ = step_s;
  tick_decode_s_ = 0;
}

int Loading::find(const std::string& name) const {
  for (int i = 0; i < sequenceCount(); ++i)
    if (sequence(i).name == name) return i;
  return -1;
}

void Loading::requestMissing(std::span<const Need> needs, int next_sequence) {
  requestMesh();
  const int most = fetches_.progressEnded() ? kGopsOnTheirWay : kGopsBeforeTheFirstPicture;
  std::vector<GopKey> keep;
  bool waits = false;
  for (const Need& need : needs) {
    requestHeader(need.sequence);
    const size_t first = keep.size();
    addNeededGops(need, keep);
    int under_way = 0;
    double ahead_s = 0;
    for (size_t i = first; i < keep.size() && under_way < most; ++i) {
      under_way += requestGop(keep[i], ahead_s, need.stands && i == first);
      ahead_s += index(need.sequence).chunks[keep[i].gop].frame_count / sequence(need.sequence).fps;
    }
    waits = waits || under_way > 0;
  }
  if (next_sequence >= 0) requestHeader(next_sequence);
  if (waits || next_sequence >= 0) cancelRaises();
  if (looks_ahead_) later<&Loading::settleAhead>(*this, needs, next_sequence, keep);
  cancelUnneeded(keep);
  if (fetches_.progressEnded() && fetches_.empty()) requestGraph();
  lower(keep);
  if (fetches_.empty()) raise(keep, !needs.empty() && needs[0].stands);
  if (looks_ahead_) later<&Loading::keepAhead>(*this, keep);
  cache_.trim(keep);
}

void Loading::requestMesh() {
  if (mesh_state_ != PartState::Absent) return;
  mesh_state_ = PartState::Fetching;
  const package::Character& c = *character_;
  fetches_.request({Kind::Mesh, -1, 0}, c.mesh_uri, c.mesh_offset, c.mesh_bytes);
}

void Loading::requestHeader(int sequence_index) {
  Stream& s = stream(sequence_index);
  if (s.header != PartState::Absent) return;
  s.header = PartState::Fetching;
  const package::Sequence& q = sequence(sequence_index);
  fetches_.request({Kind::Header, sequence_index, 0}, q.stream_uri, 0, q.stream_header_bytes);
}

void Loading::requestGraph() {
  if (graph_state_ != PartState::Absent || lacksGraph()) return;
  graph_state_ = PartState::Fetching;
  fetches_.request({Kind::Graph, -1, 0}, character_->graph_uri, 0, character_->graph_bytes);
}

// GOPs needed to play on, nearest first.
void Loading::addNeededGops(const Need& need, std::vector<GopKey>& keys) const {
  if (!playable(need.sequence)) return;
  const auto ahead = static_cast<uint32_t>(kAhead_s * sequence(need.sequence).fps);
  for (uint32_t gop : neededGops(index(need.sequence), need.frame, need.loops, ahead))
    keys.push_back({need.sequence, gop});
  if (need.fed_gop) keys.push_back({need.sequence, *need.fed_gop});
}

// True: a part of it is in flight.
bool Loading::requestGop(GopKey key, double ahead_s, bool stands) {
  const package::Sequence& q = sequence(key.sequence);
  Gop& gop = cache_.touch(key);
  const bool new_video = gop.video_state == PartState::Absent;
  if (new_video) {
    uint32_t& chosen = stream(key.sequence).rendition;
    gop.rendition = choose(key, ahead_s, stands);
    if (gop.rendition < chosen) ladder_.rest();
    if (!stands) chosen = gop.rendition;  // the rendition of a standing picture may exceed the throughput
  }
  if (gop.chunk_state == PartState::Absent) {
    gop.chunk_state = PartState::Fetching;
    gop.coarse = q.hasCoarseGeometry(gop.rendition);
    requestChunk(key, Kind::Chunk, indexOf(key, gop).chunks[key.gop]);
  } else if (!q.hasCoarseGeometry(gop.rendition)) {
    requestFine(key, gop);
  }
  if (new_video) {
    gop.video_state = PartState::Fetching;
    requestVideo(key, Kind::Video, gop.rendition);
  }
  return gop.chunk_state == PartState::Fetching || gop.video_state == PartState::Fetching;
}

const package::StreamIndex& Loading::indexOf(GopKey key, const Gop& gop) const {
  return gop.coarse ? stream(key.sequence).coarse : index(key.sequence);
}

void Loading::requestChunk(GopKey key, Kind kind, const package::ChunkEntry& entry) {
  fetches_.request({kind, key.sequence, key.gop}, sequence(key.sequence).stream_uri, entry.offset, entry.bytes);
}

// Requests, once, the chunk that replaces a coarse one.
void Loading::requestFine(GopKey key, Gop& gop) {
  if (!gop.coarse || gop.fine_state != PartState::Absent) return;
  gop.fine_state = PartState::Fetching;
  requestChunk(key, Kind::Fine, index(key.sequence).chunks[key.gop]);
}

void Loading::requestVideo(GopKey key, Kind kind, uint32_t rendition) {
  const package::ByteSpan span = index(key.sequence).renditions[rendition].videoOf(key.gop);
  const std::string& uri = sequence(key.sequence).renditions[rendition].video_uri;
  fetches_.request({kind, key.sequence, key.gop}, uri, span.offset, span.bytes);
}

// Cancels fetches made obsolete by a seek or another sequence.
void Loading::cancelUnneeded(const std::vector<GopKey>& keep) {
  fetches_.cancel([&](const FetchPurpose& purpose) {
    const GopKey key{purpose.sequence, purpose.gop};
    if (!purpose.ofGop() || purpose.ahead || std::find(keep.begin(), keep.end(), key) != keep.end()) return false;
    if (PartState* state = stateOf(purpose)) *state = PartState::Absent;
    return true;
  });
}

bool Loading::markBroken(int sequence) {
  bool news = streams_.empty();
  for (int i = 0; i < sequenceCount(); ++i) {
    if (broken(i) || (sequence >= 0 && i != sequence)) continue;
    news = stream(i).broken = true;
    cache_.dropSequence(i);
  }
  return news;
}

bool Loading::revive(int sequence_index) {
  Stream& s = stream(sequence_index);
  if (!s.broken) return false;
  s.broken = false;
  ladder_.seekAgain(sequence(sequence_index));
  for (PartState* state : {&s.header, &mesh_state_})
    if (*state == PartState::Failed) *state = PartState::Absent;
  return true;
}

const std::vector<uint8_t>* Loading::video(int sequence, uint32_t gop_index) const {
  const Gop* gop = cache_.find({sequence, gop_index});
  return gop && gop->video_state == PartState::Present ? &gop->video : nullptr;
}

bool Loading::holds(int sequence, uint32_t gop_index) const {
  const Gop* gop = cache_.find({sequence, gop_index});
  return gop && gop->video_state == PartState::Present && gop->chunk_state == PartState::Present;
}

// ---- beginnings of likely next motions, while the network is idle ----

void Loading::fetchAhead(std::span<const Landing> landings) {
  if (!ladder_.automatic() || !fetches_.empty()) return;
  std::erase_if(ahead_, [&](const GopKey& key) {
    return std::none_of(landings.begin(), landings.end(), [&](const Landing& l) { return l.sequence == key.sequence; });
  });
  for (const Landing& l : landings) {
    Stream& s = stream(l.sequence);
    if (s.broken || s.failed_ahead) continue;
    requestHeader(l.sequence);
    if (hasHeader(l.sequence)) requestAhead({l.sequence, s.index.chunkOfFrame(l.frame)});
    if (fetches_.empty()) continue;
    fetches_.forEach([](Fetch& fetch) { fetch.purpose.ahead = true; });
    return;
  }
}

// Requests the GOP unless it is loaded, or exceeds the budget or its sequence's limit.
void Loading::requestAhead(GopKey key) {
  if (std::find(ahead_.begin(), ahead_.end(), key) == ahead_.end()) {
    const auto of_sequence = [&](const GopKey& other) { return other.sequence == key.sequence; };
    if (std::count_if(ahead_.begin(), ahead_.end(), of_sequence) >= kMaxAhead) return;
    ahead_.push_back(key);
  }
  const uint32_t rendition = ladder_.lowest(sequence(key.sequence));
  const package::StreamIndex& streamed = index(key.sequence);
  const uint64_t bytes = streamed.chunks[key.gop].bytes + streamed.renditions[rendition].videoOf(key.gop).bytes;
  if (needed_bytes_ + bytesOf(ahead_) + bytes > budget_bytes_ / kBudgetDivisor) return;
  Gop& gop = cache_.touch(key);
  if (gop.video_state == PartState::Absent) {
    gop.rendition = rendition;
    gop.video_state = PartState::Fetching;
    requestVideo(key, Kind::Video, rendition);
  }
  requestGop(key, 0);
}

uint64_t Loading::bytesOf(const std::vector<GopKey>& keys) const {
  uint64_t total = 0;
  for (size_t i = 0; i < keys.size(); ++i)
    if (const Gop* gop = cache_.find(keys[i]); gop && std::find(&keys[0], &keys[i], keys[i]) == &keys[i])
      total += gop->encodedBytes();
  return total;
}

// Keeps a beginning in flight that has become a need. Cancels the others for an urgent need in flight, after a seek or
// for another motion; GOPs at the far end of the buffer load beside them.
void Loading::settleAhead(std::span<const Need> needs, int next_sequence, const std::vector<GopKey>& keep) {
  const auto needed = [&](const FetchPurpose& p) {
    if (p.ofGop()) return std::find(keep.begin(), keep.end(), GopKey{p.sequence, p.gop}) != keep.end();
    return p.sequence == next_sequence ||
           std::any_of(needs.begin(), needs.end(), [&](const Need& need) { return need.sequence == p.sequence; });
  };
  const auto soon = [&](const FetchPurpose& p) {
    const auto end = needs.size() > 1 ? keep.end() : keep.begin() + long(std::min(kSoonGops, keep.size()));
    return !p.ofGop() || std::find(keep.begin(), end, GopKey{p.sequence, p.gop}) != end;
  };
  bool urgent = false;
  fetches_.forEach([&](Fetch& fetch) {
    fetch.purpose.ahead = fetch.purpose.ahead && !needed(fetch.purpose);
    urgent = urgent || (!fetch.purpose.ahead && soon(fetch.purpose));
  });
  if (!urgent) return;
  fetches_.cancel([&](const FetchPurpose& purpose) {
    if (!purpose.ahead) return false;
    if (PartState* state = stateOf(purpose)) *state = PartState::Absent;
    return true;
  });
}

// Keeps beginnings while they fit into the budget beside the needs.
void Loading::keepAhead(std::vector<GopKey>& keep) {
  needed_bytes_ = bytesOf(keep);
  if (needed_bytes_ + bytesOf(ahead_) <= budget_bytes_) keep.insert(keep.end(), ahead_.begin(), ahead_.end());
}

}  // namespace fourdvt
