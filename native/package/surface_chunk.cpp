// SPDX-License-Identifier: Apache-2.0
#include "package/surface_chunk.h"

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "package/chunk_counts.h"
#include "package/position_model.h"
#include "package/surface_mesh.h"

namespace fourdvt::package {
namespace {

// Positions of a run's frames, in order (position_model.h).
class Motion {
 public:
  Motion(ByteReader bytes, const std::vector<glm::uvec3>& faces, std::vector<glm::ivec3> first)
      : Motion(bytes.u32(), bytes, faces, std::move(first)) {}
  // Decodes the next frame; null: corrupt, or bytes left after the last frame.
  const std::vector<glm::ivec3>* next(bool last) {
    const bool decoded = model_.frame(positions_.data()) && !bits_.overrun() && (!last || bits_.finished());
    return decoded ? &positions_ : nullptr;
  }

 private:
  Motion(uint32_t base_scale, ByteReader& bytes, const std::vector<glm::uvec3>& faces, std::vector<glm::ivec3> first)
      : mesh_(makeChunkMesh(faces, std::move(first))),
        bits_(bytes.bytes(bytes.remaining())),
        model_(bits_, mesh_, base_scale),
        positions_(mesh_.vertexCount()) {}
  const ChunkMesh mesh_;
  BinaryDecoder bits_;
  PositionModel<BinaryDecoder> model_;
  std::vector<glm::ivec3> positions_;
};

struct Run {
  uint32_t first = 0, frame_count = 0;
  std::span<const uint8_t> mesh, motion;
  std::vector<glm::uvec3> faces;  // set once the first frame is decoded
};

class RunByRun final : public SurfaceChunk {
 public:
  RunByRun(const StreamIndex& index, uint32_t chunk)
      : frame_count_(index.chunks[chunk].frame_count),
        max_vertices_(index.vertex_count),
        max_faces_(index.face_count),
        origin_(index.position_origin),
        step_m_(index.position_step_m) {}

  Status open(std::span<const uint8_t> bytes, const Character& character, const Sequence& sequence) {
    ByteReader in(bytes);
    FOURDVT_TRY(readTiles(in, character, sequence));
    return readRuns(in);
  }

  Status decodeTo(uint32_t frame) override {
    const uint32_t end = std::min(frame, frame_count_ - 1) + 1;
    while (!broken_ && decodedCount() < end) broken_ = !decodeNext();
    if (broken_) return invalidChunk("a surface does not decode");
    return {};
  }
  uint32_t decodedCount() const override { return static_cast<uint32_t>(frames_.size()); }
  Surface surface(uint32_t frame) const override {
    const Frame& f = frames_[frame];
    return {f.run, runs_[f.run].faces, f.positions};
  }
  std::span<const CameraTile> tiles() const override { return tiles_; }
  uint64_t bytes() const override { return bytes_ + tiles_.size() * sizeof(tiles_[0]); }

 private:
  struct Frame {
    uint32_t run;
    Positions positions;
  };

  static Rect readRect(ByteReader& in) {
    Rect r;
    for (int* side : {&r.x, &r.y, &r.width, &r.height}) *side = in.u16();
    return r;
  }

  Status readTiles(ByteReader& in, const Character& character, const Sequence& sequence) {
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

  Status readRuns(ByteReader& in) {
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

  bool decodeNext() {
    const uint32_t frame = decodedCount();
    if (frames_.empty() || frame == runs_[run_].first + runs_[run_].frame_count) return beginRun(frame);
    return moveOn(frame);
  }

  bool beginRun(uint32_t frame) {
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

  bool moveOn(uint32_t frame) {
    const bool last = frame + 1 == runs_[run_].first + runs_[run_].frame_count;
    const auto* positions = motion_->next(last);
    const bool appended = positions && append(*positions);
    if (last) motion_.reset();  // the model is larger than the frames
    return appended;
  }

  bool append(const std::vector<glm::ivec3>& quantised) {
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

  const uint32_t frame_count_, max_vertices_, max_faces_;
  const glm::vec3 origin_;
  const float step_m_;
  std::vector<CameraTile> tiles_;
  std::vector<Run> runs_;
  std::vector<Frame> frames_;       // decoded frames
  uint32_t run_ = 0;                // run of the last decoded frame
  std::unique_ptr<Motion> motion_;  // decoder of this run, until its last frame
  uint64_t bytes_ = 0;
  bool broken_ = false;
};

}  // namespace

Result<std::unique_ptr<SurfaceChunk>> SurfaceChunk::open(std::span<const uint8_t> bytes, const StreamIndex& index,
                                                         uint32_t chunk, const Character& character,
                                                         const Sequence& sequence) {
  if (chunk >= index.chunks.size() || index.chunks[chunk].frame_count == 0) return invalidChunk("no such GOP");
  if (!isCameraStream(index) || character.appearance != AppearanceKind::Cameras)
    return invalidChunk("the character is not from cameras");
  auto runs = std::make_unique<RunByRun>(index, chunk);
  FOURDVT_TRY(runs->open(bytes, character, sequence));
  return std::unique_ptr<SurfaceChunk>(std::move(runs));
}

}  // namespace fourdvt::package
