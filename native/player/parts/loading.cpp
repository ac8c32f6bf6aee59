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

constexpr double kAhead_s = 6;    // of what is held or on its way
constexpr double kStill_s = 2;    // that a standing picture may take to come in its best rendition
constexpr double kRaise_s = 1.5;  // that a whole sequence may, in place of a rendition between
// More would only share the network with the one that is due first.
constexpr int kGopsOnTheirWay = 2, kGopsBeforeTheFirstPicture = 1;

bool liesWithin(uint64_t offset, uint64_t bytes, uint64_t file_bytes) {
  return offset <= file_bytes && bytes <= file_bytes - offset;
}

Error named(const std::string& uri, const Error& error) { return {error.id, uri + ": " + error.message}; }

}  // namespace

Status Loading::readManifest(const FlatJson& gltf, std::span<const uint8_t> start) {
  auto read = package::readManifest(gltf);
  if (!read.ok()) return read.error();
  character_ = read.take();
  ladder_.forget();
  streams_.clear();
  streams_.resize(character_->sequences.size());
  if (fromCameras()) mesh_state_ = PartState::Present;  // every GOP brings its own
  const package::Start& s = character_->start;
  started_ = start.size() == s.bytes && !s.uri.empty() && fnv1a(start) == s.hash && takeStart(start).ok();
  fetches_.startProgress(mesh_state_ == PartState::Present ? 0 : character_->mesh_bytes);
  return {};
}

// The first sequence's frame 0 becomes a sequence of its own, with everything there that its one GOP needs.
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

uint32_t Loading::renditionOf(int sequence_index, uint32_t gop) const {
  const Gop* held = cache_.find({sequence_index, gop});
  return held && held->video_state != PartState::Absent
             ? held->rendition
             : ladder_.choose(sequence(sequence_index), stream(sequence_index).rendition);
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

// What playing on needs, nearest first.
void Loading::addNeededGops(const Need& need, std::vector<GopKey>& keys) const {
  if (!playable(need.sequence)) return;
  const auto ahead = static_cast<uint32_t>(kAhead_s * sequence(need.sequence).fps);
  for (uint32_t gop : neededGops(index(need.sequence), need.frame, need.loops, ahead))
    keys.push_back({need.sequence, gop});
  if (need.fed_gop) keys.push_back({need.sequence, *need.fed_gop});
}

// True: some of it is on its way.
bool Loading::requestGop(GopKey key, double ahead_s, bool stands) {
  const package::Sequence& q = sequence(key.sequence);
  Gop& gop = cache_.touch(key);
  const bool new_video = gop.video_state == PartState::Absent;
  if (new_video) {
    uint32_t& chosen = stream(key.sequence).rendition;
    gop.rendition = choose(key, ahead_s, stands);
    if (gop.rendition < chosen) ladder_.rest();
    if (!stands) chosen = gop.rendition;  // a standing picture may be of one that the network does not carry
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

// Requests the chunk that takes the place of a coarse one, once.
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

// The first picture comes in the lowest rendition; that of the start file is shown before its sequence.
uint32_t Loading::choose(GopKey key, double ahead_s, bool stands) const {
  const package::Sequence& q = sequence(key.sequence);
  if (!ladder_.automatic()) return ladder_.choose(q, 0);
  if (!fetches_.progressEnded() && !(started_ && key.sequence == 0)) return ladder_.lowest(q);
  return stands ? chooseStill(key) : ladder_.choose(q, stream(key.sequence).rendition, ahead_s);
}

// The highest whose bytes of the GOP come in time, whatever the rate of the rest.
uint32_t Loading::chooseStill(GopKey key) const {
  const package::Sequence& q = sequence(key.sequence);
  const package::StreamIndex& streamed = index(key.sequence);
  const double most_bytes = ladder_.throughput_bps() / 8 * kStill_s;
  for (uint32_t r = ladder_.highest(q); r > ladder_.lowest(q); --r) {
    const auto& chunks = q.hasCoarseGeometry(r) ? stream(key.sequence).coarse.chunks : streamed.chunks;
    const double bytes = double(streamed.renditions[r].videoOf(key.gop).bytes) + chunks[key.gop].bytes;
    if (!ladder_.isOut(q, r) && bytes <= most_bytes) return r;
  }
  return ladder_.lowest(q);
}

// Nothing is on its way: a loop that is held whole, and the GOP of a standing picture, which is the first, comes again
// in a higher rendition, one GOP after the other, the lowest first.
void Loading::raise(const std::vector<GopKey>& keys, bool stands) {
  GopKey chosen;
  Gop* lowest = nullptr;
  for (const GopKey& key : keys) {
    Gop* gop = cache_.find(key);
    if (!gop || gop->rendition >= ladder_.highest(sequence(key.sequence)) || gop->better_state != PartState::Absent)
      continue;
    if (!(stands && key == keys[0]) && !holdsWhole(key.sequence)) continue;
    if (lowest && lowest->rendition <= gop->rendition) continue;
    lowest = gop;
    chosen = key;
  }
  if (!lowest) return;
  lowest->better_rendition = raised(chosen.sequence, lowest->rendition);
  lowest->better_state = PartState::Fetching;
  if (!sequence(chosen.sequence).hasCoarseGeometry(lowest->better_rendition)) requestFine(chosen, *lowest);
  requestVideo(chosen, Kind::Better, lowest->better_rendition);
}

// The highest rendition, or a nearer one where that is known to take long.
uint32_t Loading::raised(int sequence_index, uint32_t from) const {
  const package::Sequence& q = sequence(sequence_index);
  const double most_bytes = ladder_.throughput_bps() / 8 * kRaise_s;
  uint32_t to = ladder_.highest(q);
  if (most_bytes <= 0) return to;
  for (uint32_t r = to; r > from; --r) {
    if (ladder_.isOut(q, r)) continue;
    to = r;
    if (double(q.renditions[r].video_bytes) <= most_bytes) break;
  }
  return to;
}

bool Loading::takeSharper(int sequence_index, uint32_t gop_index, uint32_t rendition) {
  Gop* gop = cache_.find({sequence_index, gop_index});
  if (!gop || gop->video_state != PartState::Present || gop->fine_state == PartState::Fetching) return false;
  const bool better = gop->better_state == PartState::Present && gop->better_rendition > gop->rendition;
  const uint32_t next = better ? gop->better_rendition : gop->rendition;
  const package::Sequence& q = sequence(sequence_index);
  if (next <= rendition || ladder_.tooSlow(q, next) || ladder_.isOut(q, next)) return false;
  gop->row = Gop::kNoRow;  // its decoding begins anew, with the fine geometry
  return true;
}

// A decoder is too slow for what is held: the nearest of it comes again in a lower rendition, and what is held plays
// until that is there.
void Loading::lower(const std::vector<GopKey>& keys) {
  int under_way = 0;
  for (const GopKey& key : keys) {
    Gop* gop = cache_.find(key);
    const package::Sequence& q = sequence(key.sequence);
    if (!gop || gop->video_state != PartState::Present || !ladder_.tooSlow(q, gop->rendition)) continue;
    const uint32_t rendition = ladder_.choose(q, 0);
    if (ladder_.tooSlow(q, rendition)) continue;
    if (gop->better_state == PartState::Absent ||
        (gop->better_state == PartState::Present && ladder_.tooSlow(q, gop->better_rendition))) {
      gop->better_rendition = rendition;
      gop->better_state = PartState::Fetching;
      requestVideo(key, Kind::Better, rendition);
    }
    under_way += gop->better_state == PartState::Fetching;
    if (under_way == kGopsOnTheirWay) return;
  }
}

// They would share the network with what is due.
void Loading::cancelRaises() {
  fetches_.cancel([&](const FetchPurpose& purpose) {
    const Gop* gop = cache_.find({purpose.sequence, purpose.gop});
    const bool raises =
        gop && (purpose.kind == Kind::Better
                    ? gop->better_rendition > gop->rendition
                    : purpose.kind == Kind::Fine && sequence(purpose.sequence).hasCoarseGeometry(gop->rendition));
    if (raises) *stateOf(purpose) = PartState::Absent;
    return raises;
  });
}

bool Loading::holdsWhole(int sequence) const {
  for (uint32_t g = 0; g < index(sequence).chunks.size(); ++g)
    if (!video(sequence, g)) return false;
  return true;
}

// A seek or another sequence has made them useless.
void Loading::cancelUnneeded(const std::vector<GopKey>& keep) {
  fetches_.cancel([&](const FetchPurpose& purpose) {
    const GopKey key{purpose.sequence, purpose.gop};
    if (!purpose.ofGop() || purpose.ahead || std::find(keep.begin(), keep.end(), key) != keep.end()) return false;
    if (PartState* state = stateOf(purpose)) *state = PartState::Absent;
    return true;
  });
}

// Only where decoding begins anew: within a pass all rows before would have to be decoded at once.
void Loading::takeFine(Gop& gop) {
  if (gop.fine_state != PartState::Present) return;
  gop.dropDecoded();
  gop.chunk = std::move(gop.fine);
  gop.fine.clear();
  gop.fine_state = PartState::Absent;
  gop.coarse = false;
}

void Loading::takeBetter(int sequence_index, uint32_t gop_index) {
  Gop* gop = cache_.find({sequence_index, gop_index});
  if (!gop || gop->better_state != PartState::Present) return;
  const package::Sequence& q = sequence(sequence_index);
  if (!ladder_.tooSlow(q, gop->better_rendition) || ladder_.isOut(q, gop->rendition)) {
    gop->video = std::move(gop->better);
    gop->rendition = gop->better_rendition;
  }
  gop->better.clear();
  gop->better_state = PartState::Absent;
}

void Loading::dropOtherRenditions() {
  fetches_.cancel([&](const FetchPurpose& purpose) {
    if (!purpose.ofGop()) return false;
    if (PartState* state = stateOf(purpose)) *state = PartState::Absent;
    return true;
  });
  for (int s = 0; s < sequenceCount(); ++s) {
    if (!hasHeader(s)) continue;
    stream(s).rendition = ladder_.choose(sequence(s), stream(s).rendition);
    for (uint32_t g = 0; g < index(s).chunks.size(); ++g) {
      Gop* gop = cache_.find({s, g});
      if (!gop) continue;
      gop->better_state = gop->fine_state = PartState::Absent;
      gop->better.clear();
      gop->fine.clear();
      if (gop->coarse && !sequence(s).hasCoarseGeometry(stream(s).rendition)) {
        gop->chunk_state = PartState::Absent;
        gop->dropDecoded();
        gop->chunk.clear();
      }
      if (gop->video_state != PartState::Present || gop->rendition == stream(s).rendition) continue;
      gop->video_state = PartState::Absent;
      gop->video.clear();
    }
  }
}

Arrival Loading::receive(uint32_t id, std::span<const uint8_t> bytes) {
  const Fetch* pending = fetches_.find(id);
  if (!pending) return {};
  if (bytes.size() != pending->range.bytes)
    return refuse(id, "got " + std::to_string(bytes.size()) + " bytes of " + std::to_string(pending->range.bytes));
  const FetchRange range = pending->range;
  const FetchPurpose purpose = fetches_.finish(id);
  PartState* state = stateOf(purpose);
  if (!state) return {};
  *state = PartState::Failed;  // until the bytes turn out to be good
  if (fnv1a(bytes) != hashOf(purpose)) {
    return lose(purpose, {ErrorId::FilesDiffer, range.uri + ": bytes " + std::to_string(range.offset) + "+" +
                                                    std::to_string(range.bytes) +
                                                    " are not those that were baked with character.gltf; if loading it "
                                                    "again does not help, upload all files of one bake"});
  }
  switch (purpose.kind) {
    case Kind::Mesh:
      return {Arrival::What::Mesh, -1, receiveMesh(bytes)};
    case Kind::Header: {
      const Status read = receiveHeader(purpose.sequence, bytes);
      return read.ok() ? Arrival{Arrival::What::Header, purpose.sequence, {}} : lose(purpose, read.error());
    }
    case Kind::Graph:
      later<&Loading::receiveGraph>(*this, bytes);
      break;
    default:
      receiveGop(purpose, bytes);
  }
  return {Arrival::What::Other, purpose.sequence, {}};
}

Arrival Loading::refuse(uint32_t id, const std::string& reason) {
  if (!fetches_.find(id)) return {};
  const Fetch failed = fetches_.drop(id);
  if (PartState* state = stateOf(failed.purpose)) *state = PartState::Failed;
  const FetchRange& range = failed.range;
  return lose(failed.purpose,
              {ErrorId::FetchFailed, range.uri + ": bytes " + std::to_string(range.offset) + "+" +
                                         std::to_string(range.bytes) + " could not be fetched: " + reason});
}

// Samples that cannot be had leave out their rendition, while the sequence has another one.
Arrival Loading::lose(const FetchPurpose& purpose, Error error) {
  PartState* state = stateOf(purpose);
  if (purpose.ahead) {
    stream(purpose.sequence).failed_ahead = true;
    if (state) *state = PartState::Absent;
    return {};
  }
  if (!purpose.ofVideo())
    return purpose.optional() ? Arrival{} : Arrival{Arrival::What::Nothing, purpose.sequence, error};
  if (!state) return {};
  const package::Sequence& q = sequence(purpose.sequence);
  const uint32_t rendition = renditionOf(purpose);
  const bool news = !ladder_.isOut(q, rendition);
  if (news) ladder_.miss(q.renditions[rendition]);
  if (ladder_.allOut(q)) return {Arrival::What::Nothing, purpose.sequence, error};
  *state = PartState::Absent;
  return news ? Arrival{Arrival::What::LeftOut, purpose.sequence, error}
              : Arrival{Arrival::What::Other, purpose.sequence, {}};
}

// Returns the hash that the fetched bytes must have; needs a stateOf that is not null. Each hash comes from bytes that
// were checked before, the first from the manifest.
uint64_t Loading::hashOf(const FetchPurpose& purpose) const {
  switch (purpose.kind) {
    case Kind::Mesh:
      return character_->mesh_hash;
    case Kind::Graph:
      return character_->graph_hash;
    case Kind::Header:
      return sequence(purpose.sequence).stream_header_hash;
    case Kind::Video:
    case Kind::Better:
      return index(purpose.sequence).renditions[renditionOf(purpose)].chunk_hash[purpose.gop];
    case Kind::Fine:
      return index(purpose.sequence).chunks[purpose.gop].hash;
    default: {
      const GopKey key{purpose.sequence, purpose.gop};
      return indexOf(key, *cache_.find(key)).chunks[purpose.gop].hash;
    }
  }
}

// That samples under way are of.
uint32_t Loading::renditionOf(const FetchPurpose& purpose) const {
  const Gop* gop = cache_.find({purpose.sequence, purpose.gop});
  return !gop ? 0 : purpose.kind == Kind::Video ? gop->rendition : gop->better_rendition;
}

// Null: nobody needs it any more.
PartState* Loading::stateOf(const FetchPurpose& purpose) {
  if (purpose.kind == Kind::Mesh) return &mesh_state_;
  if (purpose.kind == Kind::Graph) return &graph_state_;
  if (purpose.kind == Kind::Header) return &stream(purpose.sequence).header;
  Gop* gop = cache_.find({purpose.sequence, purpose.gop});
  if (!gop) return nullptr;
  if (purpose.kind == Kind::Better) return &gop->better_state;
  if (purpose.kind == Kind::Fine) return &gop->fine_state;
  return purpose.kind == Kind::Video ? &gop->video_state : &gop->chunk_state;
}

Status Loading::receiveMesh(std::span<const uint8_t> bytes) {
  return takeMesh(package::decodeBaseMesh(bytes, character_->face_count));
}

Status Loading::takeMesh(Result<package::BaseMesh> mesh) {
  if (!mesh.ok()) return named(character_->mesh_uri, mesh.error());
  const MeshTopology& topology = mesh.value().topology;
  if (topology.vertex_count != character_->vertex_count || topology.faceCount() != character_->face_count)
    return Error{ErrorId::MeshDataInvalid,
                 character_->mesh_uri + ": mesh and manifest disagree on vertices or faces; bake the character again"};
  mesh_ = mesh.take();
  chunk_mesh_ = package::makeChunkMesh(*mesh_);
  mesh_state_ = PartState::Present;
  return {};
}

Status Loading::receiveHeader(int sequence_index, std::span<const uint8_t> bytes) {
  auto index = package::readStreamHeader(bytes);
  if (!index.ok()) return named(sequence(sequence_index).stream_uri, index.error());
  FOURDVT_TRY(checkHeader(sequence(sequence_index), index.value()));
  if (sequence(sequence_index).coarse_renditions > 0) stream(sequence_index).coarse = index.value().coarse();
  stream(sequence_index).index = index.take();
  stream(sequence_index).header = PartState::Present;
  return {};
}

Status Loading::checkHeader(const package::Sequence& q, const package::StreamIndex& i) const {
  const auto isOf = [&](uint32_t count, uint32_t whole) { return fromCameras() ? count <= whole : count == whole; };
  if (i.frame_count != q.frame_count || !isOf(i.vertex_count, character_->vertex_count) ||
      !isOf(i.face_count, character_->face_count) || i.layer_count != static_cast<uint32_t>(character_->layer_count) ||
      i.renditions.size() != q.renditions.size() || i.member_count != q.members.size() ||
      i.reference_count != q.reference_count || i.coarse_chunks.empty() != (q.coarse_renditions == 0))
    return Error{ErrorId::StreamInvalid,
                 q.stream_uri + ": stream and manifest disagree on counts; bake the character again"};
  for (const std::vector<package::ChunkEntry>* chunks : {&i.chunks, &i.coarse_chunks})
    for (const package::ChunkEntry& chunk : *chunks)
      if (!liesWithin(chunk.offset, chunk.bytes, q.stream_bytes))
        return Error{ErrorId::StreamInvalid, q.stream_uri + ": a chunk lies beyond the end of the file"};
  for (size_t r = 0; r < q.renditions.size(); ++r)
    for (const package::VideoSample& sample : i.renditions[r].samples)
      if (!liesWithin(sample.offset, sample.bytes, q.renditions[r].video_bytes))
        return Error{ErrorId::StreamInvalid,
                     q.renditions[r].video_uri + ": a video sample lies beyond the end of the file"};
  return {};
}

void Loading::receiveGop(const FetchPurpose& purpose, std::span<const uint8_t> bytes) {
  Gop& gop = cache_.touch({purpose.sequence, purpose.gop});
  std::vector<uint8_t>& part = purpose.kind == Kind::Chunk   ? gop.chunk
                               : purpose.kind == Kind::Fine  ? gop.fine
                               : purpose.kind == Kind::Video ? gop.video
                                                             : gop.better;
  part.assign(bytes.begin(), bytes.end());
  *stateOf(purpose) = PartState::Present;
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

// Opens the decoder if that is yet to be done.
Status Loading::open(GopKey key, Gop& gop) {
  if (gop.decoded()) return {};
  const package::StreamIndex& coded = indexOf(key, gop);
  if (fromCameras()) {
    FOURDVT_ASSIGN(gop.surfaces,
                   later<&package::SurfaceChunk::open>(gop.chunk, coded, key.gop, *character_, sequence(key.sequence)));
  } else {
    FOURDVT_ASSIGN(gop.geometry, package::ChunkDecoder::open(gop.chunk, coded, key.gop, chunk_mesh_));
  }
  return {};
}

// Decodes as far as a row, or one step: kStep. Opening the decoder is one of the steps.
Status Loading::decode(GopKey key, Gop& gop, uint32_t row) {
  const bool timed = slice_ && slice_->now_s, opens = !gop.decoded();
  const double start_s = timed ? slice_->now_s() : 0;
  const uint32_t rows = gop.decodedRows();
  Status status = open(key, gop);
  if (status.ok() && !(opens && row == kStep))
    status = gop.surfaces   ? gop.surfaces->decodeTo(row == kStep ? rows : row)
             : row == kStep ? gop.geometry->step()
                            : gop.geometry->decodeTo(row);
  gop.damaged = !status.ok();
  const uint32_t more = gop.decodedRows() - rows;
  decoded_.rows += more;
  if (timed) {
    const double spent_s = slice_->now_s() - start_s;
    decoded_.timed_rows += more;
    decoded_.seconds += spent_s;
    tick_decode_s_ += spent_s;
    decoded_.longest_tick_s = std::max(decoded_.longest_tick_s, tick_decode_s_);
  }
  return status;
}

// A frame of the GOP is wanted: a pass of it begins, or goes on.
void Loading::enter(Gop& gop, uint32_t row) {
  if (row < gop.row || !gop.decoded()) takeFine(gop);
  gop.row = row;
}

Status Loading::geometry(int sequence_index, uint32_t frame, bool due, FrameGeometry& out) {
  if (mesh_state_ != PartState::Present || !playable(sequence_index)) return {};
  const package::StreamIndex& streamed = index(sequence_index);
  const GopKey key{sequence_index, streamed.chunkOfFrame(frame)};
  Gop* gop = cache_.find(key);
  if (!gop || gop->chunk_state != PartState::Present) return {};
  const uint32_t row = frame - streamed.chunks[key.gop].first_frame;
  enter(*gop, row);
  if (slice_ && !gop->damaged && row >= gop->decodedRows() + due) return {};
  const Status status = decode(key, *gop, row);
  if (!status.ok()) return named(sequence(sequence_index).stream_uri, status.error());
  if (row >= gop->decodedRows()) return {};  // it is decoded elsewhere
  out = {gop->geometry ? &gop->geometry->frames() : nullptr, &indexOf(key, *gop), row, gop->surfaces.get()};
  return {};
}

}  // namespace fourdvt
