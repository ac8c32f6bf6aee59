// SPDX-License-Identifier: Apache-2.0
// Fetch results: arrivals are checked and stored; failures leave out a rendition or break their sequence.
#include "base/hash.h"
#include "base/later.h"
#include "package/mesh_code.h"
#include "player/parts/loading.h"

namespace fourdvt {

using Kind = FetchPurpose::Kind;

namespace {

bool liesWithin(uint64_t offset, uint64_t bytes, uint64_t file_bytes) {
  return offset <= file_bytes && bytes <= file_bytes - offset;
}

Error named(const std::string& uri, const Error& error) { return {error.id, uri + ": " + error.message}; }

}  // namespace

Arrival Loading::receive(uint32_t id, std::span<const uint8_t> bytes) {
  const Fetch* pending = fetches_.find(id);
  if (!pending) return {};
  if (bytes.size() != pending->range.bytes)
    return refuse(id, "got " + std::to_string(bytes.size()) + " bytes of " + std::to_string(pending->range.bytes));
  const FetchRange range = pending->range;
  const FetchPurpose purpose = fetches_.finish(id);
  PartState* state = stateOf(purpose);
  if (!state) return {};
  *state = PartState::Failed;  // provisional: the bytes are unchecked
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

// Leaves out the rendition of lost samples while the sequence has another one.
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

// Expected hash of the fetched bytes; requires a non-null stateOf. Each hash comes from bytes checked before, the first
// from the manifest.
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

// Rendition of the samples in flight.
uint32_t Loading::renditionOf(const FetchPurpose& purpose) const {
  const Gop* gop = cache_.find({purpose.sequence, purpose.gop});
  return !gop ? 0 : purpose.kind == Kind::Video ? gop->rendition : gop->better_rendition;
}

// State of the fetched part; null: no longer needed.
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

// Treats an unreadable graph as absent: states are then selected by cuts.
void Loading::receiveGraph(std::span<const uint8_t> bytes) {
  auto graph = motion::MotionGraph::read(bytes, *character_);
  graph_state_ = graph.ok() ? PartState::Present : PartState::Failed;
  if (graph.ok()) graph_ = graph.take();
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

}  // namespace fourdvt
