// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/reconstruct.h"

#include "mattes/frame_reader.h"
#include "platform/process.h"
#include "reconstruct/run/finish.h"
#include "reconstruct/run/sequence_frames.h"

namespace fourdvt::reconstruct {
namespace {

// Computes all windows in one process, then finishes.
class Run {
 public:
  Run(const Prepared& job, const ReconstructEnvironment& environment, SurfaceMaker& maker, const Watch& watch)
      : job_(job),
        environment_(environment),
        maker_(maker),
        watch_(watch),
        store_(resultFolder(job.options), job.capture, job.settings_key) {}

  Result<ReconstructSummary> run() {
    for (const capture::CaptureSequence& sequence : job_.capture.sequences) total_ += sequence.frame_count;
    for (const capture::CaptureSequence& sequence : job_.capture.sequences) FOURDVT_TRY(runSequence(sequence));
    tell("report");
    FOURDVT_ASSIGN(const auto summary, writeResult(job_, store_, pictures_, RunTime{done_ - made_, watch_.seconds()}));
    FOURDVT_TRY(resultFolder(job_.options).finish());
    return summary;
  }

 private:
  Status runSequence(const capture::CaptureSequence& sequence) {
    FOURDVT_TRY(store_.makeFolders(sequence.name));
    const uint32_t shown = shownFrame(sequence);
    bool drawn = false;
    const auto made = [&](uint32_t frame, const mattes::CaptureFrame& captured, const FrameSurface& surface) {
      if (frame == shown) {
        pictures_.add(sequence.name, frame, captured.pictures, surface);
        drawn = true;
      }
      ++done_, ++made_;
      tell(sequence.name + " " + std::to_string(frame + 1) + "/" + std::to_string(sequence.frame_count));
    };
    SequenceFrames frames(job_, environment_, store_, maker_, sequence);
    for (uint32_t window = 0; window < windowsOf(sequence); ++window) {
      FOURDVT_ASSIGN(const uint32_t kept, frames.makeWindow(window, made));
      done_ += kept;
    }
    return drawn ? Status() : drawKept(job_, store_, sequence, shown, environment_.open_video, pictures_);
  }

  void tell(const std::string& stage) const {
    if (!environment_.progress) return;
    FrameProgress p{stage, done_, total_, 0, 0};
    if (made_ > 0) {
      p.frames_per_s = made_ / watch_.seconds();
      p.left_s = (total_ - done_) / p.frames_per_s;
    }
    environment_.progress(p);
  }

  const Prepared& job_;
  const ReconstructEnvironment& environment_;
  SurfaceMaker& maker_;
  const Watch watch_;
  const FrameStore store_;
  ReportPictures pictures_;
  uint32_t total_ = 0, done_ = 0, made_ = 0;
};

}  // namespace

std::string ReconstructOptions::check() const {
  if (stereo && hull == HullKind::Polyhedral)
    return "--refine stereo works inside the volumetric hull; leave out --hull polyhedral, or --refine stereo";
  return {};
}

Result<ReconstructSummary> reconstruct(const ReconstructOptions& options, const ReconstructEnvironment& environment) {
  const Threads threads(options.jobs);
  platform::keepFreedMemory();
  Watch watch;
  Preparation preparation(options, environment);
  FOURDVT_TRY(preparation.link(options.resume ? Earlier::Kept : Earlier::Removed));
  // Reports an unusable device before mattes are computed.
  FOURDVT_ASSIGN(auto maker, SurfaceMaker::create(options, preparation.capture().cameras, environment.device));
  if (preparation.wantsMattes()) {
    FOURDVT_TRY(preparation.addMattes());
    watch = {};
  }
  const Prepared job = preparation.take();
  return Run(job, environment, maker, watch).run();
}

}  // namespace fourdvt::reconstruct
