// SPDX-License-Identifier: Apache-2.0
#include "package/surface_chunk.h"

#include <algorithm>
#include <cmath>

#include "package/chunk_counts.h"
#include "package/position_model.h"
#include "package/surface_mesh.h"

namespace fourdvt::package {
namespace {

Rect readRect(ByteReader& in) {
  Rect r;
  for (int* side : {&r.x, &r.y, &r.width, &r.height}) *side = in.u16();
  return r;
}

}  // namespace

// Positions of a run's frames, in order (position_model.h).
class SurfaceChunk::Motion {
 public:
  Motion(ByteReader bytes, const std::vector<glm::uvec3>& faces, std::vector<glm::ivec3> first)
      : Motion({bytes.u32(), bytes.u32()}, bytes, faces, std::move(first)) {}
  // Decodes the next frame; null: corrupt, or bytes left after the last frame.
  const std::vector<glm::ivec3>* next(bool last) {
    const bool decoded = model_.frame(positions_.data()) && !bits_.overrun() && (!last || bits_.finished());
    return decoded ? &positions_ : nullptr;
  }

 private:
  Motion(const PositionScale& scale, ByteReader& bytes, const std::vector<glm::uvec3>& faces,
         std::vector<glm::ivec3> first)
      : mesh_(makeChunkMesh(faces, std::move(first))),
        bits_(bytes.bytes(bytes.remaining())),
        model_(bits_, mesh_, scale),
        positions_(mesh_.vertexCount()) {}
  const ChunkMesh mesh_;
  BinaryDecoder bits_;
  PositionModel<BinaryDecoder> model_;
  std::vector<glm::ivec3> positions_;
};

SurfaceChunk::SurfaceChunk(const StreamIndex& index, uint32_t chunk)
    : frame_count_(index.chunks[chunk].frame_count),
      max_vertices_(index.vertex_count),
      max_faces_(index.face_count),
      origin_(index.position_origin),
      step_m_(index.position_step_m) {}
SurfaceChunk::~SurfaceChunk() = default;

Status SurfaceChunk::read(std::span<const uint8_t> bytes, const Character& character, const Sequence& sequence) {
  ByteReader in(bytes);
  FOURDVT_TRY(readTiles(in, character, sequence));
  return readRuns(in);
}

Status SurfaceChunk::readTiles(ByteReader& in, const Character& character, const Sequence& sequence) {
  if (in.u32() != character.cameras.size()) return invalidChunk("camera count is not the manifest's");
  for (const PinholeCamera& camera : character.cameras) {
    CameraTile& t = tiles_.emplace_back();
    t.source = readRect(in);
    t.tile = readRect(in);
    const auto sum = [](const Rect& r) { return r.x + r.y + r.width + r.height; };
    if (sum(t.source) + sum(t.tile) == 0) continue;
    const auto inside = [](const Rect& r, int width, int height) {
      return r.width > 0 && r.height > 0 && r.x + r.width <= width && r.y + r.height <= height;
    };
    if (!inside(t.source, camera.width, camera.height)) return invalidChunk("a tile's source is outside the picture");
    if (!inside(t.tile, sequence.layout_width, sequence.layout_height))
      return invalidChunk("a tile is outside the layout");
  }
  return {};
}

Status SurfaceChunk::readRuns(ByteReader& in) {
  const uint32_t count = in.u32();
  if (!in.ok() || count == 0 || count > frame_count_ || in.remaining() / 12 < count)
    return invalidChunk("bad run count");
  ByteReader lengths(in.bytes(size_t(12) * count));
  uint64_t first = 0;
  for (uint32_t r = 0; r < count; ++r) {
    Run& run = runs_.emplace_back();
    run.first = static_cast<uint32_t>(first);
    run.frame_count = lengths.u32();
    run.mesh = in.bytes(lengths.u32());
    run.motion = in.bytes(lengths.u32());
    first += run.frame_count;
    if (run.frame_count == 0) return invalidChunk("a run has no frames");
    if ((run.frame_count == 1) != run.motion.empty()) return invalidChunk("a run's motion does not match its frames");
  }
  if (first != frame_count_) return invalidChunk("runs do not cover all frames");
  if (!in.ok() || in.remaining() != 0) return invalidChunk("length differs from its header");
  frames_.reserve(frame_count_);  // keeps surfaces at their addresses
  return {};
}

bool SurfaceChunk::decodeNext() {
  const uint32_t frame = decodedCount();
  if (frames_.empty() || frame == runs_[run_].first + runs_[run_].frame_count) return beginRun(frame);
  return moveOn(frame);
}

bool SurfaceChunk::beginRun(uint32_t frame) {
  if (!frames_.empty()) ++run_;
  Run& run = runs_[run_];
  auto mesh = decodeSurfaceMesh(run.mesh, max_vertices_, max_faces_);
  if (!mesh) return false;
  run.faces = std::move(mesh->faces);
  bytes_ += run.faces.size() * sizeof(run.faces[0]);
  if (run.frame_count == 1) return append(mesh->positions);
  motion_ = std::make_unique<Motion>(ByteReader(run.motion), run.faces, std::move(mesh->positions));
  return moveOn(frame);
}

bool SurfaceChunk::moveOn(uint32_t frame) {
  const bool last = frame + 1 == runs_[run_].first + runs_[run_].frame_count;
  const auto* positions = motion_->next(last);
  const bool appended = positions && append(*positions);
  if (last) motion_.reset();  // the model is larger than the frames
  return appended;
}

bool SurfaceChunk::append(const std::vector<glm::ivec3>& quantised) {
  Positions positions;
  positions.reserve(quantised.size());
  for (const glm::ivec3& q : quantised) {
    const glm::vec3& p = positions.emplace_back(origin_ + step_m_ * glm::vec3(q));
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
  }
  bytes_ += positions.size() * sizeof(positions[0]);
  frames_.push_back({run_, std::move(positions)});
  return true;
}

Status SurfaceChunk::decodeTo(uint32_t frame) {
  const uint32_t end = std::min(frame, frame_count_ - 1) + 1;
  while (!broken_ && decodedCount() < end) broken_ = !decodeNext();
  if (broken_) return invalidChunk("a surface does not decode");
  return {};
}

Surface SurfaceChunk::surface(uint32_t frame) const {
  const Frame& f = frames_[frame];
  return {f.run, runs_[f.run].faces, f.positions};
}

Result<std::unique_ptr<SurfaceChunk>> SurfaceChunk::open(std::span<const uint8_t> bytes, const StreamIndex& index,
                                                         uint32_t chunk, const Character& character,
                                                         const Sequence& sequence) {
  if (chunk >= index.chunks.size() || index.chunks[chunk].frame_count == 0) return invalidChunk("no such GOP");
  if (!isCameraStream(index) || character.appearance != AppearanceKind::Cameras)
    return invalidChunk("the character is not from cameras");
  std::unique_ptr<SurfaceChunk> out(new SurfaceChunk(index, chunk));
  FOURDVT_TRY(out->read(bytes, character, sequence));
  return out;
}

}  // namespace fourdvt::package
