// SPDX-License-Identifier: Apache-2.0
// The first pass over a capture: visibility of every face in every camera and frame, colour calibration between the
// cameras, and then labels for whole sequences. All results are stored in files (BakeOptions::survey_folder) under a
// key of the capture and of the settings that they depend on, so that bakes of the same capture share them and an
// interrupted one resumes. Visibility is measured in windows of frames; each has a file of its own and reads no other
// frames.
// Memory: one frame of pictures and labelling's window, whatever the length.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bake/labels/schedule.h"
#include "bake/run/bake_run.h"
#include "bake/texels/frame_baker.h"
#include "mattes/frame_reader.h"

namespace fourdvt::bake {

// Windows in which the labels of a sequence are solved.
std::vector<LabelWindow> planLabelWindows(const Job& job, const capture::CaptureSequence& sequence);
// Frames before and after a window that contribute to its face costs.
constexpr uint32_t kHysteresisFrames = 2;
// Compares colours in every kColourEvery-th of the first kColourFrames frames of a sequence.
constexpr uint32_t kColourEvery = 4, kColourFrames = 32;

// Stores the solved windows of a sequence's labels, in files beside the labels', until the labels are complete. Damaged
// files count as absent.
LabelKeeper windowKeeper(const std::string& labels_path);
// Removes the windows of this sequence's labels only.
void removeWindows(const std::string& labels_path);

class Survey {
 public:
  // The survey borrows the run's job. Errors: those of capture and GPU, NothingVisible, WriteFailed, Interrupted.
  static Result<Survey> make(BakeRun& run);
  // Opens the stored measurements; the functions below add to them. Errors: WriteFailed.
  static Result<Survey> open(BakeRun& run);
  // Measures the visibility of the window that begins at this frame.
  Status measureFrom(BakeRun& run, const capture::CaptureSequence& sequence, uint32_t first);
  // Calibrates the cameras' colours, on frames whose visibility is measured.
  Status matchColours(BakeRun& run);
  // Solves labels in some of the sequence's windows (planLabelWindows), and stores them for labelSequence.
  Status labelWindows(BakeRun& run, const capture::CaptureSequence& sequence, const std::vector<size_t>& windows);
  // Labels a whole sequence, from windows that are stored or solved now.
  Status labelSequence(BakeRun& run, const capture::CaptureSequence& sequence);
  bool isMeasuredFrom(const capture::CaptureSequence& sequence, uint32_t first) const {
    return isMeasured(sequence, windowOf(sequence, first));
  }
  bool isLabelled(const capture::CaptureSequence& sequence) { return loadStatistics(sequence); }

  const std::vector<ColourMap>& colourMaps() const { return colour_maps_; }  // empty without colour calibration
  // [layer][face]. Errors: FileUnreadable.
  Result<std::vector<uint8_t>> labels(const capture::CaptureSequence& sequence, uint32_t frame) const;
  // [rank][face]: all cameras that qualify, in order of their penalties; for BakeOptions::texel_rule.
  Result<std::vector<uint8_t>> penaltyOrder(const capture::CaptureSequence& sequence, uint32_t frame) const;
  const std::map<std::string, LabelStatistics>& statistics() const { return statistics_; }  // by sequence

 private:
  struct Window {  // frames whose visibility is in one file
    uint32_t first, end;
    uint32_t count() const { return end - first; }
  };
  using OnFrame = std::function<void(uint32_t done)>;
  using LabelSolve = std::function<Status(const LabelOptions&, const FaceGraph&, const LabelExchange&)>;
  Status withLabelExchange(BakeRun& run, const capture::CaptureSequence& sequence, const OnFrame& on_frame,
                           const LabelSink& sink, const LabelSolve& solve);
  struct Measuring {
    std::unique_ptr<FrameBaker> baker;
    ColourCalibrator* calibrator = nullptr;       // null: the colour maps exist already
    std::unique_ptr<mattes::FrameReader> reader;  // stays open over neighbouring windows
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
  bool matchesColours() const { return job_->options.colour_calibration && job_->cameras.size() > 1; }
  Status keepColours(BakeRun& run, const ColourCalibrator& calibrator);
  bool loadStatistics(const capture::CaptureSequence& sequence);
  Result<FaceCosts> faceCosts(const capture::CaptureSequence& sequence, uint32_t frame) const;
  Result<std::vector<float>> fractions(const capture::CaptureSequence& sequence, uint32_t frame) const;
  size_t fractionBytes() const { return job_->cameras.size() * job_->mesh.decoded.topology.faceCount(); }  // per frame
  size_t labelBytes() const { return job_->options.layers * job_->mesh.decoded.topology.faceCount(); }     // per frame
  const std::string& labelsPath(const capture::CaptureSequence& sequence) const {
    return paths_.at(sequence.name).labels;
  }

  struct Paths {
    std::string fractions, labels;  // fractions before the window's frames
  };
  const Job* job_;
  std::string folder_, colours_path_;
  std::map<std::string, Paths> paths_;  // by sequence; cached so that the capture's files are examined only once
  std::vector<ColourMap> colour_maps_;
  std::map<std::string, LabelStatistics> statistics_;
};

}  // namespace fourdvt::bake

namespace fourdvt::store {

void fields(Archive& a, bake::LabelStatistics& s);

}  // namespace fourdvt::store
