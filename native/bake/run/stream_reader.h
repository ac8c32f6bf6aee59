// SPDX-License-Identifier: Apache-2.0
// What a stream's frame is made of: each member's pictures at the nearest captured frame, and the meshes at the frame's
// own time with the corrections of their blend. Does NOT touch the GPU.
#pragma once

#include <optional>

#include "bake/run/mesh_reader.h"
#include "bake/run/geometry.h"
#include "bake/texels/picture_crop.h"

namespace fourdvt::bake {

// A captured frame, decoded mesh's order.
struct SourceFrame {
  Positions pose;
  std::vector<PictureCrop> crops;  // [camera]
};

struct PreparedMember {
  uint32_t source_frame = 0;
  // At most one of them; none: the same captured frame as in the stream's frame read before.
  std::optional<SourceFrame> fresh;
  std::vector<Image> kept_layers;  // of a class: filled, as the member's own stream left them in the work folder
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
    std::unique_ptr<capture::FrameReader> reader;
    uint32_t next = 0;
    std::optional<uint32_t> last;  // read last
  };
  StreamReader(BakeRun& run, const StreamPlan& plan)
      : run_(run), plan_(plan), meshes_(run.job), sources_(plan.motion.members.size()) {}
  Result<PreparedMember> readMember(size_t member, uint32_t frame);
  std::vector<Image> keptLayers(size_t member, uint32_t source_frame) const;  // empty: none are kept
  Result<SourceFrame> readSource(size_t member, uint32_t source_frame);
  Result<FrameGeometry> blendGeometry(uint32_t frame);  // of a class

  BakeRun& run_;
  const StreamPlan& plan_;
  MeshReader meshes_;
  std::vector<Source> sources_;  // [member]
  std::unique_ptr<NonlinearBlend> blend_;
};

}  // namespace fourdvt::bake
