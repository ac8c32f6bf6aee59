// SPDX-License-Identifier: Apache-2.0
// Reads a stream's frames, on the CPU: each member's pictures at the nearest captured frame, and the meshes at the
// frame's own time with the corrections of their blend. Codes their geometry.
#pragma once

#include <list>
#include <optional>

#include "bake/run/bake_run.h"
#include "bake/run/job.h"
#include "bake/texels/picture_crop.h"
#include "mattes/frame_reader.h"
#include "package/stream_file.h"

namespace fourdvt::bake {

// Reads captured meshes in place (readMeshFrameInPlace), in the decoded mesh's order, and caches the latest ones,
// because interpolation between frames reads each of them several times. Not thread-safe.
class MeshReader {
 public:
  explicit MeshReader(const Job& job) : job_(&job) {}
  // Errors: those of readMeshFrameInPlace.
  Result<Positions> read(const capture::CaptureSequence& sequence, uint32_t frame);
  // Reader as a function, which borrows it.
  ReadPositions function() {
    return [this](const capture::CaptureSequence& sequence, uint32_t frame) { return read(sequence, frame); };
  }

 private:
  static constexpr size_t kKept = 24;  // four frames of each of four members, and a margin
  struct Entry {
    const capture::CaptureSequence* sequence;
    uint32_t frame;
    Positions positions;
  };
  const Job* job_;
  std::list<Entry> entries_;  // the most recently used first
};

// The meshes of one frame, in the decoded mesh's order.
struct FrameGeometry {
  std::vector<Positions> members;  // [member]
  std::vector<Positions> offsets;  // [reference]: corrections of the mesh blend
  std::vector<glm::vec3> root;     // [member]
};

// A captured frame, decoded mesh's order.
struct SourceFrame {
  Positions pose;                  // in the room, where pictures show it
  std::vector<PictureCrop> crops;  // [camera]
};

struct PreparedMember {
  uint32_t source_frame = 0;
  // At most one of the two; none: same captured frame as in the stream's previous frame.
  std::optional<SourceFrame> fresh;
  std::vector<Image> kept_layers;  // for a class: filled, from the member's own stream, stored in the work folder
};

struct PreparedFrame {
  std::vector<PreparedMember> members;
  FrameGeometry geometry;
};

class StreamReader {
 public:
  // Errors: MeshTopology. Videos are opened with the first frame.
  static Result<std::unique_ptr<StreamReader>> create(BakeRun& run, const StreamPlan& plan);
  // Cheap in ascending order: captured frames are decoded once, and videos reopened where a loop wraps. Errors: those
  // of capture.
  Result<PreparedFrame> read(uint32_t frame);

 private:
  struct Source {
    std::unique_ptr<mattes::FrameReader> reader;
    uint32_t next = 0;
    std::optional<uint32_t> last;  // latest frame
  };
  StreamReader(BakeRun& run, const StreamPlan& plan)
      : run_(run), plan_(plan), meshes_(run.job), sources_(plan.motion.members.size()) {}
  Result<PreparedMember> readMember(size_t member, uint32_t frame);
  std::vector<Image> keptLayers(size_t member, uint32_t source_frame) const;  // empty if none are stored
  Result<SourceFrame> readSource(size_t member, uint32_t source_frame);
  Result<FrameGeometry> blendGeometry(uint32_t frame);  // meshes of a class

  BakeRun& run_;
  const StreamPlan& plan_;
  MeshReader meshes_;
  std::vector<Source> sources_;  // [member]
  std::optional<NonlinearBlend> blend_;
};

// Grid position at which a point is streamed, in whole steps from the origin.
inline glm::dvec3 gridPlace(const glm::vec3& point, const glm::dvec3& origin, double step_m) {
  return glm::round((glm::dvec3(point) - origin) / step_m);
}

// Quantises the frames of one GOP as coded in the package.
class ChunkBuilder {
 public:
  ChunkBuilder(const Job& job, const StreamPlan& plan);
  // labels: [member][layer][face].
  void add(const FrameGeometry& geometry, const std::vector<uint8_t>& labels);
  // Returns the added frames; the builder is empty afterwards.
  package::ChunkFrames finish();

 private:
  void quantise(const Positions& positions, const glm::dvec3& origin, std::vector<glm::ivec3>& out) const;
  glm::dvec3 origin_;
  double step_m_;
  package::ChunkFrames empty_, frames_;
};

// Codes a GOP's frames into the work folder: first coarsely if a rendition uses coarse geometry, then at full
// precision. Errors: WriteFailed, Internal.
Status saveChunks(const BakeRun& run, const StreamPlan& plan, uint32_t gop, const package::ChunkFrames& frames,
                  const package::ChunkMesh& mesh);

}  // namespace fourdvt::bake
