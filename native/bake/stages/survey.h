// SPDX-License-Identifier: Apache-2.0
// The first pass over a capture: visibility of every face in every camera and frame, the cameras' colours against each
// other, and then labels for whole sequences. Everything is kept in files (BakeOptions::survey_folder) under a key of
// the capture and of the settings it depends on, so that bakes of the same capture share it and an interrupted one goes
// on. Memory: one frame of pictures and labelling's window, whatever the length.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bake/run/environment.h"
#include "bake/run/job.h"
#include "bake/stages/frame_baker.h"

namespace fourdvt::bake {

class Survey {
 public:
  // `share`: of the survey, 0..1. Errors: those of capture and GPU, NothingVisible, WriteFailed, Interrupted.
  using OnProgress = std::function<void(const std::string& stage, double share)>;
  static Result<Survey> run(const Job& job, const BakeEnvironment& environment, StageClock& clock,
                            const OnProgress& on_progress);

  const std::vector<ColourMap>& colourMaps() const { return colour_maps_; }  // empty: not calibrated
  // [layer][face]. Errors: FileUnreadable.
  Result<std::vector<uint8_t>> labels(const SequencePlan& plan, uint32_t frame) const;
  // [rank][face]: all cameras that qualify, by penalty. For LabelMode::PerTexel.
  Result<std::vector<uint8_t>> penaltyOrder(const SequencePlan& plan, uint32_t frame) const;
  const std::map<std::string, LabelStatistics>& statistics() const { return statistics_; }  // by sequence

 private:
  explicit Survey(const Job& job);
  Status measure(const BakeEnvironment& environment, StageClock& clock, const OnProgress& on_progress);
  Status measureSequence(const SequencePlan& plan, FrameBaker& baker, const BakeEnvironment& environment,
                         StageClock& clock, ColourCalibrator* calibrator,
                         const std::function<void(uint32_t)>& on_frame);
  Status label(const SequencePlan& plan, const BakeEnvironment& environment, StageClock& clock,
               const std::function<void(uint32_t)>& on_frame);
  bool loadColours();
  Status saveColours() const;
  bool loadStatistics(const SequencePlan& plan);
  Result<FaceCosts> faceCosts(const SequencePlan& plan, uint32_t frame) const;
  Result<std::vector<float>> fractions(const SequencePlan& plan, uint32_t frame) const;
  size_t fractionBytes() const { return job_->cameras.size() * job_->mesh.decoded.topology.faceCount(); }  // a frame
  size_t labelBytes() const { return job_->options.layers * job_->mesh.decoded.topology.faceCount(); }     // a frame
  const std::string& fractionsPath(const SequencePlan& plan) const { return paths_.at(plan.source->name).fractions; }
  const std::string& labelsPath(const SequencePlan& plan) const { return paths_.at(plan.source->name).labels; }

  struct Paths {
    std::string fractions, labels;
  };
  const Job* job_;
  std::string folder_, colours_path_;
  std::map<std::string, Paths> paths_;  // by sequence; the capture's files are looked at once
  std::vector<ColourMap> colour_maps_;
  std::map<std::string, LabelStatistics> statistics_;
};

}  // namespace fourdvt::bake
