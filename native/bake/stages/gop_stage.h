// SPDX-License-Identifier: Apache-2.0
// Every GOP that the work folder has not yet: resample → fill → tile → encode, and plain sequences' chunks. Three lanes
// overlap: reading the next frame, the GPU's stages of this one (on the calling thread, which owns the context),
// filling and encoding the one before. A class shows its members' frames as their own streams have drawn and filled
// them: these are kept in the work folder meanwhile, and drawn again where an interrupted bake left none.
#pragma once

#include <future>

#include "bake/run/bake_run.h"
#include "bake/run/stream_reader.h"
#include "bake/stages/survey.h"
#include "bake/texels/frame_baker.h"
#include "package/chunk_mesh.h"

namespace fourdvt::bake {

class GopStage {
 public:
  GopStage(BakeRun& run, const Survey& survey) : run_(run), job_(run.job), survey_(survey) {}

  Status run();  // Errors: those of capture, GPU and encoder, WriteFailed, Interrupted
  // One GOP alone. Layers that classes show stay in the work folder.
  Status runOne(const StreamPlan& plan, uint32_t gop);
  uint32_t framesBaked() const { return baked_; }  // by this run

 private:
  struct OpenGop;
  struct MemberLook {  // one member's share of the picture
    std::vector<uint8_t> labels;
    std::vector<Image> layers;
    bool filled = false;
    Image atlas;
  };
  struct DrawnFrame {
    std::vector<std::optional<MemberLook>> members;  // none: as before
    FrameGeometry geometry;
  };

  Status start();
  Status bakeStream(const StreamPlan& plan);
  Result<std::unique_ptr<StreamReader>> openStream(const StreamPlan& plan);
  bool isFinished(const StreamPlan& plan, uint32_t gop) const;
  Status bakeGop(const StreamPlan& plan, uint32_t gop, StreamReader& reader);
  Result<DrawnFrame> drawFrame(const StreamPlan& plan, PreparedFrame frame);
  Result<MemberLook> drawMember(const capture::CaptureSequence& sequence, uint32_t source_frame,
                                const SourceFrame& source);
  Result<MemberLook> keptMember(const capture::CaptureSequence& sequence, PreparedMember kept) const;
  void keepForClasses(const StreamPlan& plan, uint32_t frame);
  Status finishFrame(OpenGop& open, const StreamPlan& plan, DrawnFrame frame, uint32_t index);
  Status encode(OpenGop& open, const StreamPlan& plan, const std::vector<const Image*>& layers, uint32_t index);
  Status saveStill();
  Status saveGop(OpenGop& open, const StreamPlan& plan, uint32_t gop);
  Status waitForSave();
  void tellFrame(const StreamPlan& plan, uint32_t frame);
  bool isFirst(const StreamPlan& plan) const { return &plan == job_.streams.data(); }
  std::launch lane() const { return job_.options.jobs > 1 ? std::launch::async : std::launch::deferred; }

  BakeRun& run_;
  const Job& job_;
  const Survey& survey_;
  package::ChunkMesh chunk_mesh_;
  std::unique_ptr<FrameBaker> frames_;
  std::vector<MemberLook> looks_;  // of the stream's frame finished last
  encode::I420Picture picture_;
  std::vector<bool> kept_;      // [frame] of the stream: a class shows it later
  std::future<Status> saving_;  // of the GOP before; ends before the next encoder is made: only one is in memory
  uint32_t baked_ = 0;
  double started_s_ = 0;
};

}  // namespace fourdvt::bake
