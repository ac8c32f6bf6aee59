// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/bytes.h"
#include "package/chunk_encode.h"
#include "package/residual_model.h"
#include "package/surface_mesh.h"

namespace fourdvt::package {
namespace {

Error chunkFailed(const std::string& what) { return {ErrorId::Internal, "surfaces: " + what}; }

struct EncodedRun {
  uint32_t frame_count = 1, vertex_count = 0, face_count = 0;
  std::vector<uint8_t> mesh, motion;
  size_t bytes() const { return 12 + mesh.size() + motion.size(); }
};

bool hasArea(const glm::uvec3& f) { return f.x != f.y && f.y != f.z && f.z != f.x; }

// Returns the frame to code: the input without faces of zero area.
Result<QuantisedSurface> checked(const QuantisedSurface& frame) {
  QuantisedSurface out{{}, frame.positions};
  std::copy_if(frame.faces.begin(), frame.faces.end(), std::back_inserter(out.faces), hasArea);
  if (out.faces.empty()) return chunkFailed("a frame has no faces");
  for (const glm::uvec3& f : out.faces) {
    if (std::max({f.x, f.y, f.z}) >= out.positions.size()) return chunkFailed("a face's vertex does not exist");
  }
  if (!std::all_of(out.positions.begin(), out.positions.end(), inRange))
    return chunkFailed("a position is out of range; the position step is too small");
  return out;
}

EncodedRun runOf(const EncodedSurfaceMesh& mesh) {
  EncodedRun run;
  run.vertex_count = static_cast<uint32_t>(mesh.decoded.positions.size());
  run.face_count = static_cast<uint32_t>(mesh.decoded.faces.size());
  run.mesh = mesh.bytes;
  return run;
}

// Codes all frames as the motion of the first frame's mesh.
Result<EncodedRun> movingRun(const EncodedSurfaceMesh& first, std::span<const QuantisedSurface> frames) {
  FOURDVT_ASSIGN(const auto source, sourceVertices(frames[0], first.decoded));
  EncodedRun run = runOf(first);
  run.frame_count = static_cast<uint32_t>(frames.size());
  ChunkFrames motion;
  motion.frame_count = run.frame_count;
  motion.vertex_count = run.vertex_count;
  motion.face_count = run.face_count;
  for (const QuantisedSurface& frame : frames) {
    for (uint32_t v : source) motion.positions.push_back(frame.positions[v]);
  }
  run.motion = encodePositions(motion, makeChunkMesh(first.decoded.faces, first.decoded.positions), 0, 1);
  return run;
}

// Codes frames of one topology as one run or as runs of one frame each, whichever is smaller.
Status encodeRuns(std::span<const QuantisedSurface> frames, std::vector<EncodedRun>& out) {
  std::vector<EncodedRun> single;
  EncodedRun moving;
  size_t bytes = 0;
  for (size_t f = 0; f < frames.size(); ++f) {
    FOURDVT_ASSIGN(const auto mesh, encodeSurfaceMesh(frames[f]));
    if (f == 0 && frames.size() > 1) {
      FOURDVT_ASSIGN(moving, movingRun(mesh, frames));
    }
    bytes += single.emplace_back(runOf(mesh)).bytes();
    if (frames.size() > 1 && bytes >= moving.bytes()) {
      out.push_back(std::move(moving));
      return {};
    }
  }
  std::move(single.begin(), single.end(), std::back_inserter(out));
  return {};
}

bool sameTopology(const QuantisedSurface& a, const QuantisedSurface& b) {
  return a.positions.size() == b.positions.size() && a.faces == b.faces;
}

void writeRect(ByteWriter& out, const Rect& r) {
  for (int side : {r.x, r.y, r.width, r.height}) out.u16(static_cast<uint16_t>(side));
}

}  // namespace

Result<EncodedSurfaces> encodeSurfaceChunk(std::span<const CameraTile> tiles,
                                           std::span<const QuantisedSurface> frames) {
  std::vector<QuantisedSurface> surfaces;
  for (const QuantisedSurface& frame : frames) {
    FOURDVT_ASSIGN(surfaces.emplace_back(), checked(frame));
  }
  std::vector<EncodedRun> runs;
  for (size_t first = 0, end = 0; first < surfaces.size(); first = end) {
    for (end = first + 1; end < surfaces.size() && sameTopology(surfaces[first], surfaces[end]);) ++end;
    FOURDVT_TRY(encodeRuns(std::span(surfaces).subspan(first, end - first), runs));
  }
  EncodedSurfaces out;
  ByteWriter bytes;
  bytes.u32(static_cast<uint32_t>(tiles.size()));
  for (const CameraTile& t : tiles) writeRect(bytes, t.source), writeRect(bytes, t.tile);
  bytes.u32(static_cast<uint32_t>(runs.size()));
  for (const EncodedRun& run : runs) {
    bytes.u32(run.frame_count);
    bytes.u32(static_cast<uint32_t>(run.mesh.size()));
    bytes.u32(static_cast<uint32_t>(run.motion.size()));
    out.vertex_count = std::max(out.vertex_count, run.vertex_count);
    out.face_count = std::max(out.face_count, run.face_count);
  }
  for (const EncodedRun& run : runs) bytes.bytes(run.mesh), bytes.bytes(run.motion);
  out.run_count = static_cast<uint32_t>(runs.size());
  out.bytes = bytes.take();
  return out;
}

}  // namespace fourdvt::package
