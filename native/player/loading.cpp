// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "player/player_impl.h"

namespace fourdvt {

using stream::GopKey;
using stream::PartState;

namespace {
constexpr int kTries = 3;
constexpr uint32_t kGopsAhead = 1;
}  // namespace

Status PlayerImpl::loadManifest(const FlatJson& gltf) {
  auto read = package::readManifest(gltf);
  if (!read.ok()) {
    fail(read.error(), -1);
    return read.error();
  }
  character_ = read.take();
  sequences_.clear();
  sequences_.resize(character_->sequences.size());
  const int first = wanted_name_.empty() ? 0 : findSequence(wanted_name_);
  emit(EventKind::LoadedMetadata);
  progress_total_ = character_->mesh_bytes;
  select(std::max(first, 0));
  if (first < 0) return Error{ErrorId::InvalidArgument, "the character has no sequence named " + wanted_name_};
  return {};
}

bool PlayerImpl::ready(const Track& t) const {
  if (!t.used() || !model_) return false;
  const SequenceState& state = stateOf(t);
  return state.header == PartState::Present && !state.broken;
}

void PlayerImpl::requestFetch(PartKind kind, int sequence, uint32_t gop, const std::string& uri, uint64_t offset,
                              uint64_t bytes) {
  const uint32_t id = next_fetch_id_++;
  FetchRange range{id, uri, offset, bytes};
  fetches_[id] = {kind, sequence, gop, 1, range};
  requests_.emplace_back(std::in_place_type<FetchRange>, range);
}

// Asks for whatever the wanted position lacks: mesh and header first, then its GOP, then the next one; then the same of
// the state that comes next.
void PlayerImpl::requestMissing() {
  if (!main().used()) return;
  if (mesh_state_ == PartState::Absent) {
    mesh_state_ = PartState::Fetching;
    requestFetch(PartKind::Mesh, -1, 0, character_->mesh_uri, character_->mesh_offset, character_->mesh_bytes);
  }
  requestTrack(main());
  if (other().used()) requestTrack(other());
  if (transition_.phase == Phase::Wanted) requestHeader(transition_.target);
  if (can_play_ && fetches_.empty()) requestGraph();
  std::vector<GopKey> keep;
  addNeededGops(main(), keep);
  addNeededGops(other(), keep);
  cache_.trim(keep);
}

void PlayerImpl::requestTrack(const Track& t) {
  requestHeader(t.sequence);
  std::vector<GopKey> needed;
  addNeededGops(t, needed);
  for (const GopKey& key : needed) requestGop(key.sequence, key.gop);
}

void PlayerImpl::requestHeader(int sequence_index) {
  const package::Sequence& sequence = sequenceAt(sequence_index);
  SequenceState& state = sequences_[static_cast<size_t>(sequence_index)];
  if (state.header != PartState::Absent) return;
  state.header = PartState::Fetching;
  if (!can_play_) progress_total_ += sequence.stream_header_bytes;
  requestFetch(PartKind::Header, sequence_index, 0, sequence.stream_uri, 0, sequence.stream_header_bytes);
}

void PlayerImpl::requestGraph() {
  if (graph_state_ != PartState::Absent || character_->graph_uri.empty()) return;
  graph_state_ = PartState::Fetching;
  requestFetch(PartKind::Graph, -1, 0, character_->graph_uri, 0, character_->graph_bytes);
}

// What playing on needs, nearest first.
void PlayerImpl::addNeededGops(const Track& t, std::vector<GopKey>& keys) const {
  if (!t.used()) return;
  const SequenceState& state = stateOf(t);
  if (state.header != PartState::Present || state.broken) return;
  for (uint32_t gop : stream::neededGops(state.index, frameOf(t, positionOf(t)), looping(t), kGopsAhead))
    keys.push_back({t.sequence, gop});
  if (t.feeding && !t.feed_done) keys.push_back({t.sequence, t.feed_gop});
}

void PlayerImpl::requestGop(int sequence_index, uint32_t gop_index) {
  const package::Sequence& sequence = sequenceAt(sequence_index);
  const package::StreamIndex& index = sequences_[static_cast<size_t>(sequence_index)].index;
  stream::Gop& gop = cache_.touch({sequence_index, gop_index});
  if (gop.chunk_state == PartState::Absent) {
    gop.chunk_state = PartState::Fetching;
    const package::ChunkEntry& entry = index.chunks[gop_index];
    if (!can_play_) progress_total_ += entry.bytes;
    requestFetch(PartKind::Chunk, sequence_index, gop_index, sequence.stream_uri, entry.offset, entry.bytes);
  }
  if (gop.video_state == PartState::Absent) {
    gop.video_state = PartState::Fetching;
    const package::SampleTable& table = index.renditions[0];
    const package::VideoSample& first = table.samples[table.chunk_first_sample[gop_index]];
    const package::VideoSample& last = table.samples[table.chunk_first_sample[gop_index + 1] - 1];
    const uint64_t bytes = last.offset + last.bytes - first.offset;
    if (!can_play_) progress_total_ += bytes;
    requestFetch(PartKind::Video, sequence_index, gop_index, sequence.renditions[0].video_uri, first.offset, bytes);
  }
}

void PlayerImpl::reportProgress(uint64_t more_bytes) {
  stats_.bytes_fetched += more_bytes;
  if (can_play_) return;
  progress_loaded_ += more_bytes;
  Event event{EventKind::Progress, {}, progress_loaded_, std::max(progress_total_, progress_loaded_)};
  events_.push_back(event);
}

Status PlayerImpl::receiveMesh(std::span<const uint8_t> bytes) {
  auto mesh = package::decodeBaseMesh(bytes);
  if (!mesh.ok()) return Error{mesh.error().id, character_->mesh_uri + ": " + mesh.error().message};
  if (mesh.value().topology.vertex_count != character_->vertex_count ||
      mesh.value().topology.faceCount() != character_->face_count)
    return Error{ErrorId::MeshDataInvalid,
                 character_->mesh_uri + ": mesh and manifest disagree on vertices or faces; bake the character again"};
  auto model = render::CharacterModel::create(device_, *character_, mesh.value());
  if (!model.ok()) return model.error();
  mesh_ = mesh.take();
  chunk_mesh_ = package::makeChunkMesh(*mesh_);
  model_ = model.take();
  mesh_state_ = PartState::Present;
  return {};
}

Status PlayerImpl::receiveHeader(int sequence_index, std::span<const uint8_t> bytes) {
  const package::Sequence& sequence = sequenceAt(sequence_index);
  auto index = package::readStreamHeader(bytes);
  if (!index.ok()) return Error{index.error().id, sequence.stream_uri + ": " + index.error().message};
  const package::StreamIndex& i = index.value();
  if (i.frame_count != sequence.frame_count || i.vertex_count != character_->vertex_count ||
      i.face_count != character_->face_count || i.layer_count != static_cast<uint32_t>(character_->layer_count) ||
      i.renditions.size() != sequence.renditions.size() || i.member_count != sequence.members.size() ||
      i.reference_count != sequence.reference_count)
    return Error{ErrorId::StreamInvalid,
                 sequence.stream_uri + ": stream and manifest disagree on counts; bake the character again"};
  for (const package::ChunkEntry& chunk : i.chunks)
    if (chunk.offset > sequence.stream_bytes || chunk.bytes > sequence.stream_bytes - chunk.offset)
      return Error{ErrorId::StreamInvalid, sequence.stream_uri + ": a chunk lies beyond the end of the file"};
  for (const package::VideoSample& sample : i.renditions[0].samples)
    if (sample.offset > sequence.renditions[0].video_bytes ||
        sample.bytes > sequence.renditions[0].video_bytes - sample.offset)
      return Error{ErrorId::StreamInvalid,
                   sequence.renditions[0].video_uri + ": a video sample lies beyond the end of the file"};
  SequenceState& state = sequences_[static_cast<size_t>(sequence_index)];
  state.index = index.take();
  state.header = PartState::Present;
  return {};
}

// A graph that cannot be read counts as none: states are then simply selected.
void PlayerImpl::receiveGraph(std::span<const uint8_t> bytes) {
  auto graph = motion::MotionGraph::read(bytes, *character_);
  graph_state_ = graph.ok() ? PartState::Present : PartState::Failed;
  if (graph.ok()) graph_ = graph.take();
}

void PlayerImpl::onRangeReceived(uint32_t id, std::span<const uint8_t> bytes) {
  auto it = fetches_.find(id);
  if (it == fetches_.end()) return;
  const Fetch fetch = it->second;
  if (bytes.size() != fetch.range.bytes) {
    onRangeFailed(id, "got " + std::to_string(bytes.size()) + " bytes of " + std::to_string(fetch.range.bytes));
    return;
  }
  fetches_.erase(it);
  reportProgress(bytes.size());
  Status status;
  if (fetch.kind == PartKind::Mesh) {
    status = receiveMesh(bytes);
  } else if (fetch.kind == PartKind::Graph) {
    receiveGraph(bytes);
  } else if (fetch.kind == PartKind::Header) {
    status = receiveHeader(fetch.sequence, bytes);
    for (Track& t : tracks_)
      if (status.ok() && fetch.sequence == t.sequence) restartFeed(t);
  } else {
    stream::Gop& gop = cache_.touch({fetch.sequence, fetch.gop});
    const bool video = fetch.kind == PartKind::Video;
    (video ? gop.video : gop.chunk).assign(bytes.begin(), bytes.end());
    (video ? gop.video_state : gop.chunk_state) = PartState::Present;
  }
  if (!status.ok()) fail(status.error(), fetch.sequence);
  requestMissing();
}

void PlayerImpl::onRangeFailed(uint32_t id, const std::string& reason) {
  auto it = fetches_.find(id);
  if (it == fetches_.end()) return;
  if (it->second.tries < kTries) {
    ++it->second.tries;
    requests_.emplace_back(std::in_place_type<FetchRange>, it->second.range);
    return;
  }
  const Fetch fetch = it->second;
  fetches_.erase(it);
  if (fetch.kind == PartKind::Graph) {
    graph_state_ = PartState::Failed;
    return;
  }
  if (stream::Gop* gop = fetch.kind == PartKind::Video || fetch.kind == PartKind::Chunk
                             ? cache_.find({fetch.sequence, fetch.gop})
                             : nullptr)
    (fetch.kind == PartKind::Video ? gop->video_state : gop->chunk_state) = PartState::Failed;
  fail({ErrorId::FetchFailed, fetch.range.uri + ": bytes " + std::to_string(fetch.range.offset) + "+" +
                                  std::to_string(fetch.range.bytes) + " could not be fetched (" + reason +
                                  "); check that the file is complete on the server"},
       fetch.sequence);
}

// Reports and stops asking for what is broken: one sequence, or everything (-1). The player itself stays usable.
void PlayerImpl::fail(Error error, int broken_sequence) {
  bool news = sequences_.empty();
  for (size_t i = 0; i < sequences_.size(); ++i) {
    if (sequences_[i].broken || (broken_sequence >= 0 && static_cast<int>(i) != broken_sequence)) continue;
    news = sequences_[i].broken = true;
    cache_.dropSequence(static_cast<int>(i));
  }
  if (!news) return;
  for (Track& t : tracks_)
    if (broken_sequence < 0 || broken_sequence == t.sequence) stopFeed(t);
  if (broken_sequence < 0 || broken_sequence == transition_.target) cancelTransition();
  Event event{EventKind::Error, std::move(error), 0, 0};
  events_.push_back(std::move(event));
}

// Geometry of the GOP that holds the frame, decoded as far as this frame, or null while it is not there (or broken).
const package::ChunkFrames* PlayerImpl::geometryOf(int sequence_index, uint32_t frame) {
  SequenceState& state = sequences_[static_cast<size_t>(sequence_index)];
  if (mesh_state_ != PartState::Present || state.header != PartState::Present || state.broken) return nullptr;
  const uint32_t gop_index = state.index.chunkOfFrame(frame);
  stream::Gop* gop = cache_.find({sequence_index, gop_index});
  if (!gop || gop->chunk_state != PartState::Present) return nullptr;
  Status status;
  if (!gop->geometry) {
    auto opened = package::ChunkDecoder::open(gop->chunk, state.index, gop_index, chunk_mesh_);
    if (opened.ok())
      gop->geometry = opened.take();
    else
      status = opened.error();
  }
  if (status.ok()) status = gop->geometry->decodeTo(frame - state.index.chunks[gop_index].first_frame);
  if (!status.ok()) {
    const std::string& uri = sequenceAt(sequence_index).stream_uri;
    fail({status.error().id, uri + ": " + status.error().message}, sequence_index);
    return nullptr;
  }
  return &gop->geometry->frames();
}

}  // namespace fourdvt
