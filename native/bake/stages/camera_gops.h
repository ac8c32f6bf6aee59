// SPDX-License-Identifier: Apache-2.0
// Every GOP of a character from cameras that the work folder has not yet: crops, colours, fill → tiled picture →
// encode, and the surfaces as a chunk. Reading the next frame, drawing this one's tiles and encoding the one before
// overlap. Memory: two frames of pictures, one GOP of surfaces and packets.
#pragma once

#include <future>

#include "bake/run/bake_run.h"
#include "bake/texels/colour_calibration.h"

namespace fourdvt::bake {

class CameraGops {
 public:
  // maps: one per camera, or none.
  CameraGops(BakeRun& run, std::vector<ColourMap> maps) : run_(run), job_(run.job), maps_(std::move(maps)) {}

  Status run();  // Errors: those of capture and encoder, WriteFailed, Interrupted
  Status runOne(const StreamPlan& plan, uint32_t gop);  // one GOP alone
  uint32_t framesBaked() const { return baked_; }       // by this run

 private:
  struct OpenGop;
  bool isFinished(const StreamPlan& plan, uint32_t gop) const;
  Status bakeStream(const StreamPlan& plan);
  Result<std::unique_ptr<OpenGop>> drawGop(const StreamPlan& plan, uint32_t gop, capture::FrameReader& reader);
  Status drawFrame(OpenGop& open, const StreamPlan& plan, const capture::CaptureFrame& frame);
  Status encode(OpenGop& open, const StreamPlan& plan, uint32_t index, const encode::I420Picture& picture,
                const std::vector<Image>& drawn);
  Status saveGop(OpenGop& open, const StreamPlan& plan, uint32_t gop);
  void tellFrame(const StreamPlan& plan, uint32_t frame);
  std::launch lane() const { return job_.options.jobs > 1 ? std::launch::async : std::launch::deferred; }

  BakeRun& run_;
  const Job& job_;
  const std::vector<ColourMap> maps_;
  uint32_t baked_ = 0;
  double started_s_ = 0;
};

}  // namespace fourdvt::bake
