// SPDX-License-Identifier: Apache-2.0
// The first pass over a capture: visibility of every face in every camera and frame, the cameras' colours against each
// other, and then labels for whole sequences. Everything is kept in files (BakeOptions::survey_folder) under a key of
// the capture and of the settings it depends on, so that bakes of the same capture share it and an interrupted one goes
// on. Visibility is measured in windows of frames; each has a file of its own and reads no other frames.
// Memory: one frame of pictures and labelling's window, whatever the length.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bake/run/bake_run.h"
#include "bake/stages/frame_baker.h"

namespace fourdvt::bake {

class Survey {
 public:
  // The survey borrows the run's job. Errors: those of capture and GPU, NothingVisible, WriteFailed, Interrupted.
  static Result<Survey> make(BakeRun& run);

  const std::vector<ColourMap>& colourMaps() const { return colour_maps_; }  // empty if colours are not calibrated
  // [layer][face]. Errors: FileUnreadable.
  Result<std::vector<uint8_t>> labels(const capture::CaptureSequence& sequence, uint32_t frame) const;
  // [rank][face]: all cameras that qualify, in order of their penalties; for BakeOptions::texel_rule.
  Result<std::vector<uint8_t>> penaltyOrder(const capture::CaptureSequence& sequence, uint32_t frame) const;
  const std::map<std::string, LabelStatistics>& statistics() const { return statistics_; }  // by sequence

 private:
  struct Window {  // of frames whose visibility is in one file
    uint32_t first, end;
    uint32_t count() const { return end - first; }
  };
  using OnFrame = std::function<void(uint32_t done)>;
  struct Measuring {
    std::unique_ptr<FrameBaker> baker;
    ColourCalibrator* calibrator = nullptr;        // null: the colour maps are known already
    std::unique_ptr<capture::FrameReader> reader;  // stays open over neighbouring windows
    OnFrame on_frame;
  };
  explicit Survey(const Job& job);
  Status measure(BakeRun& run, StageProgress& progress);
  Status measureSequence(BakeRun& run, const capture::CaptureSequence& sequence, Measuring& measuring);
  Status measureWindow(BakeRun& run, const capture::CaptureSequence& sequence, const Window& window,
                       Measuring& measuring);
  Window windowOf(const capture::CaptureSequence& sequence, uint32_t frame) const;
  static bool showsColours(const Window& window);
  bool isMeasured(const capture::CaptureSequence& sequence, const Window& window) const;
  std::string fractionsPath(const capture::CaptureSequence& sequence, const Window& window) const;
  Status label(BakeRun& run, const capture::CaptureSequence& sequence, const OnFrame& on_frame);
  bool loadColours();
  Status saveColours() const;
  bool loadStatistics(const capture::CaptureSequence& sequence);
  Result<FaceCosts> faceCosts(const capture::CaptureSequence& sequence, uint32_t frame) const;
  Result<std::vector<float>> fractions(const capture::CaptureSequence& sequence, uint32_t frame) const;
  size_t fractionBytes() const { return job_->cameras.size() * job_->mesh.decoded.topology.faceCount(); }  // a frame
  size_t labelBytes() const { return job_->options.layers * job_->mesh.decoded.topology.faceCount(); }     // a frame
  const std::string& labelsPath(const capture::CaptureSequence& sequence) const {
    return paths_.at(sequence.name).labels;
  }

  struct Paths {
    std::string fractions, labels;  // of fractions, before the window's frames
  };
  const Job* job_;
  std::string folder_, colours_path_;
  std::map<std::string, Paths> paths_;  // by sequence; kept so that the capture's files are examined only once
  std::vector<ColourMap> colour_maps_;
  std::map<std::string, LabelStatistics> statistics_;
};

}  // namespace fourdvt::bake
