// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/reconstruct.h"

#include <tbb/global_control.h>

#include <chrono>
#include <opencv2/core/utility.hpp>
#include <optional>

#include "reconstruct/run/frame_store.h"
#include "reconstruct/run/frame_surface.h"
#include "reconstruct/run/linked_capture.h"
#include "reconstruct/run/report.h"

namespace fourdvt::reconstruct {
namespace {

using Clock = std::chrono::steady_clock;

constexpr uint32_t kWindow = 32;  // frames after which a surface no longer depends on those before

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

class Run {
 public:
  Run(const ReconstructOptions& options, const ReconstructEnvironment& environment, const capture::Capture& capture)
      : options_(options),
        environment_(environment),
        capture_(capture),
        store_(options.folder, capture.metres_per_unit) {
    for (const capture::CaptureCamera& camera : capture.cameras) cameras_.push_back(camera.pinhole);
    for (const capture::CaptureSequence& sequence : capture.sequences) total_ += sequence.frame_count;
  }

  Result<ReconstructSummary> run() {
    FOURDVT_ASSIGN(auto maker, SurfaceMaker::create(options_, capture_.cameras, environment_.device));
    FOURDVT_TRY(store_.open(settingsKey(options_, capture_), options_.resume));
    std::vector<std::string> names;
    for (const capture::CaptureSequence& sequence : capture_.sequences) names.push_back(sequence.name);
    FOURDVT_TRY(linkCapture(capture_.folder, store_.resultFolder(), names));
    FOURDVT_TRY(checkLinks(names));
    std::vector<ReconstructedSequence> done;
    ReportPictures pictures;
    for (const capture::CaptureSequence& sequence : capture_.sequences) {
      FOURDVT_ASSIGN(auto frames, runSequence(sequence, maker, pictures));
      done.push_back({sequence.name, std::move(frames)});
    }
    tell("report");
    ReconstructSummary summary = summarise(capture_, done);
    summary.frames_kept = kept_;
    summary.wall_s = since(started_);
    FOURDVT_TRY(writeReport(store_.resultFolder(), options_, capture_, done, pictures, summary));
    FOURDVT_TRY(store_.finish());
    return summary;
  }

 private:
  // Everything that the new capture.json names must be found from the new folder.
  Status checkLinks(const std::vector<std::string>& names) const {
    const auto linked =
        capture::openCapture(store_.resultFolder(), environment_.open_video, names, capture::MeshNeed::Nothing);
    if (linked.ok()) return {};
    return Error{linked.error().id, capture_.folder +
                                        "/capture.json: names files outside of the capture or in a sequence that is "
                                        "left out; move them into folders of their own inside it (" +
                                        linked.error().message + ")"};
  }

  // The frame to go on with: stereo keeps surfaces steady, so that they depend on the frames before them in a window.
  uint32_t firstToMake(const capture::CaptureSequence& sequence) const {
    uint32_t frame = 0;
    while (frame < sequence.frame_count && store_.find(sequence.name, frame)) ++frame;
    if (frame == sequence.frame_count || !options_.stereo) return frame;
    return frame / kWindow * kWindow;
  }

  // A frame that an earlier run finished, drawn for the report.
  Status showKept(const capture::CaptureSequence& sequence, uint32_t frame, capture::FrameReader& reader,
                  ReportPictures& pictures) const {
    reader.skipTo(frame);
    FOURDVT_ASSIGN(const auto captured, reader.next());
    FrameSurface surface;
    FOURDVT_ASSIGN(surface.mesh, store_.loadMesh(sequence.name, frame));
    surface.silhouettes = silhouettesOf(cameras_, captured.pictures);
    pictures.add(sequence.name, frame, captured.pictures, surface);
    return {};
  }

  Result<std::vector<FrameFigures>> runSequence(const capture::CaptureSequence& sequence, SurfaceMaker& maker,
                                                ReportPictures& pictures) {
    FOURDVT_TRY(store_.makeFolders(sequence.name));
    FOURDVT_ASSIGN(auto reader, capture::FrameReader::open(capture_, sequence, environment_.open_video));
    std::vector<FrameFigures> out;
    const auto earliest = store_.find(sequence.name, 0);
    FOURDVT_TRY(maker.begin(earliest ? &*earliest : nullptr));
    const uint32_t first = firstToMake(sequence), shown = sequence.frame_count / 2;
    for (uint32_t frame = 0; frame < sequence.frame_count; ++frame) {
      if (frame < first) {
        if (frame == shown) FOURDVT_TRY(showKept(sequence, frame, *reader, pictures));
        out.push_back(*store_.find(sequence.name, frame));
        ++kept_, ++done_;
        continue;
      }
      if (environment_.stop && *environment_.stop) {
        return Error{ErrorId::Interrupted,
                     "stopped; finished frames are kept in " + store_.resultFolder() + " for --resume"};
      }
      const auto begun = Clock::now();
      reader->skipTo(frame);
      FOURDVT_ASSIGN(const auto captured, reader->next());
      const double read_ms = since(begun) * 1e3;
      if (frame % kWindow == 0) maker.forget();
      auto surface = maker.make(captured.pictures);
      if (!surface.ok()) {
        return Error{surface.error().id, sequence.folder + ", frame " + std::to_string(frame) + ": " +
                                             surface.error().message + "; finished frames are kept for --resume"};
      }
      FrameFigures& figures = surface.value().figures;
      figures.read_ms = read_ms;
      if (frame == shown) pictures.add(sequence.name, frame, captured.pictures, surface.value());
      FOURDVT_TRY(store_.save(sequence.name, frame, surface.value().mesh, figures));
      out.push_back(std::move(figures));
      ++done_, ++made_;
      tell(sequence.name + " " + std::to_string(frame + 1) + "/" + std::to_string(sequence.frame_count));
    }
    return out;
  }

  void tell(const std::string& stage) const {
    if (!environment_.progress) return;
    ReconstructProgress p{stage, done_, total_, 0, 0};
    if (made_ > 0) {
      p.frames_per_s = made_ / since(started_);
      p.left_s = (total_ - done_) / p.frames_per_s;
    }
    environment_.progress(p);
  }

  const ReconstructOptions& options_;
  const ReconstructEnvironment& environment_;
  const capture::Capture& capture_;
  FrameStore store_;
  std::vector<PinholeCamera> cameras_;
  Clock::time_point started_ = Clock::now();
  uint32_t total_ = 0, done_ = 0, made_ = 0, kept_ = 0;
};

}  // namespace

std::string ReconstructOptions::check() const {
  if (stereo && hull == HullKind::Polyhedral)
    return "--refine stereo works inside the volumetric hull; leave out --hull polyhedral, or --refine stereo";
  return {};
}

Result<ReconstructSummary> reconstruct(const ReconstructOptions& given, const ReconstructEnvironment& environment) {
  ReconstructOptions options = given;
  FOURDVT_ASSIGN(options.folder, checkedTarget(given));
  std::optional<tbb::global_control> threads;  // OpenVDB's; the others are OpenCV's
  if (options.jobs > 0) {
    cv::setNumThreads(options.jobs);
    threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.jobs));
  }
  FOURDVT_ASSIGN(const auto capture, capture::openCapture(options.capture_folder, environment.open_video,
                                                          options.sequences, capture::MeshNeed::Nothing));
  return Run(options, environment, capture).run();
}

}  // namespace fourdvt::reconstruct
