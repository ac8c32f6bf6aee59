// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/reconstruct.h"

#include <tbb/global_control.h>

#include <chrono>
#include <filesystem>
#include <opencv2/core/utility.hpp>
#include <optional>

#include "capture/folder/linked_capture.h"
#include "mattes/agreement.h"
#include "mattes/run/matte_sources.h"
#include "mattes/run/mattes.h"
#include "reconstruct/run/frame_store.h"
#include "reconstruct/run/frame_surface.h"
#include "reconstruct/run/report.h"
#include "refine/run/calibrate_capture.h"
#include "refine/run/calibration_report.h"

namespace fourdvt::reconstruct {
namespace {

using Clock = std::chrono::steady_clock;

const capture::FolderWriter kWriter{"reconstruct", kReportJson, ""};
constexpr size_t kFewestCalibrated = 4;  // cameras; the silhouettes of fewer hardly contradict each other
constexpr uint32_t kWindow = 32;         // frames after which a surface no longer depends on those before

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

class Run {
 public:
  Run(const ReconstructOptions& options, const ReconstructEnvironment& environment, const capture::Capture& capture,
      bool wants_mattes)
      : options_(options),
        environment_(environment),
        capture_(capture),
        wants_mattes_(wants_mattes),
        folder_(options.folder, kWriter) {}

  Result<ReconstructSummary> run() {
    FOURDVT_TRY(folder_.open(settingsKey(options_, capture_), options_.resume));
    FOURDVT_TRY(link());
    const FrameStore store(folder_, capture_);
    store_ = &store;
    FOURDVT_ASSIGN(auto maker, SurfaceMaker::create(options_, capture_.cameras, environment_.device));
    for (const capture::CaptureCamera& camera : capture_.cameras) cameras_.push_back(camera.pinhole);
    for (const capture::CaptureSequence& sequence : capture_.sequences) total_ += sequence.frame_count;
    if (wants_mattes_) FOURDVT_TRY(addMattes());
    std::vector<ReconstructedSequence> done;
    ReportPictures pictures;
    for (const capture::CaptureSequence& sequence : capture_.sequences) {
      FOURDVT_ASSIGN(auto frames, runSequence(sequence, maker, pictures));
      done.push_back({sequence.name, std::move(frames)});
    }
    tell("report");
    ReconstructSummary summary = summarise(capture_, done);
    summary.frames_kept = kept_;
    summary.warnings.insert(summary.warnings.begin(), warnings_.begin(), warnings_.end());
    summary.wall_s = since(started_);
    FOURDVT_TRY(writeReport(folder_.partFolder(), options_, capture_, done, pictures, summary));
    FOURDVT_TRY(folder_.finish());
    return summary;
  }

 private:
  // The new folder with all that is not made; of an earlier run's, the calibration holds.
  Status link() {
    capture::LinkOptions link;
    for (const capture::CaptureSequence& sequence : capture_.sequences) link.sequences.push_back(sequence.name);
    link.own_meshes = true;
    link.leave_out = options_.leave_out;
    const std::string done = folder_.partFolder() + "/" + refine::kCalibrationJson;
    std::error_code none;
    const bool calibrates = options_.synchronise || options_.refine_cameras;
    if (!calibrates || !std::filesystem::exists(done, none)) {
      if (calibrates) FOURDVT_TRY(calibrate(link));
      FOURDVT_TRY(capture::linkCapture(capture_, folder_.partFolder(), link));
      if (calibration_)
        FOURDVT_TRY(refine::writeCalibrationReport(folder_.partFolder(), options_.capture_folder, *calibration_));
    }
    FOURDVT_TRY(openLinked(link.sequences));
    for (size_t c = 0; c < capture_.cameras.size(); ++c) capture_.cameras[c].pinhole = linked_.cameras[c].pinhole;
    for (size_t s = 0; s < capture_.sequences.size(); ++s) {
      capture::CaptureSequence &here = capture_.sequences[s], &there = linked_.sequences[s];
      here.frame_count = there.frame_count, here.first_frame = there.first_frame;
      here.offset_frames = there.offset_frames, here.test_frames = there.test_frames;
    }
    return {};
  }

  // Cameras in step and in place, by silhouettes that each camera has by itself: mattes that are made with the others'
  // help agree with them already.
  Status calibrate(capture::LinkOptions& link) {
    if (capture_.cameras.size() < kFewestCalibrated) return {};
    refine::CalibrationOptions options;
    options.times = options_.synchronise, options.cameras = options_.refine_cameras;
    const auto found =
        refine::calibrate(capture_, environment_.open_video, options, [&](const std::string& what, double) {
          tell("calibrating: " + what);
          return !environment_.stop || !*environment_.stop;
        });
    if (!found.ok() && found.error().id == ErrorId::Interrupted) return found.error();
    if (!found.ok()) {
      warnings_.push_back("cameras stay as given in time and place: " + found.error().message);
      return {};
    }
    calibration_ = found.value();
    refine::applyCalibration(*calibration_, capture_);
    link.own_calibration = link.own_times = calibration_->changed();
    for (const std::string& line : refine::calibrationLines(*calibration_))
      if (calibration_->changed()) warnings_.push_back(line);
    warnings_.insert(warnings_.end(), calibration_->warnings.begin(), calibration_->warnings.end());
    return {};
  }

  // Everything that the new capture.json names must be found from the new folder, from which frames are read.
  Status openLinked(const std::vector<std::string>& names) {
    auto linked = capture::openCapture(folder_.partFolder(), environment_.open_video, names, capture::MeshNeed::Nothing,
                                       capture::MatteNeed::None);
    if (linked.ok()) {
      linked_ = linked.take();
      return {};
    }
    return Error{linked.error().id, capture_.folder +
                                        "/capture.json: names files outside of the capture or in a sequence that is "
                                        "left out; move them into folders of their own inside it (" +
                                        linked.error().message + ")"};
  }

  // Makes the mattes that are missing, cameras together; colour keys are made as frames are read.
  Status addMattes() {
    mattes::MattesOptions options;
    options.alone = options_.mattes_alone;
    options.any_silhouettes = options_.any_silhouettes;
    mattes::MattesEnvironment environment{environment_.open_video, {}, environment_.stop};
    environment.progress = [&](const mattes::MattesProgress& p) {
      if (environment_.progress) environment_.progress({p.stage, p.done, p.total, p.frames_per_s, p.left_s});
    };
    FOURDVT_ASSIGN(const auto summary,
                   mattes::addMattes(capture_, folder_.partFolder(), folder_.workFolder(), options, environment));
    warnings_.insert(warnings_.end(), summary.warnings.begin(), summary.warnings.end());
    started_ = Clock::now();
    return {};
  }

  // Silhouettes that no common volume explains make no surface: said after the first frame.
  Status checkAgreement(const capture::CaptureSequence& sequence, uint32_t frame, const std::vector<Image>& pictures) {
    if (options_.any_silhouettes || options_.mattes_alone || agreed_ == sequence.name) return {};
    std::vector<capture::CaptureCamera> cameras;
    std::vector<cv::Mat> masks;
    size_t seeing = 0;
    for (size_t i = 0; i < pictures.size(); ++i) {
      cameras.push_back({cameras_[i], {}});
      cv::Mat mask(pictures[i].height, pictures[i].width, CV_8U);
      for (int k = 0; k < int(mask.total()); ++k)
        mask.at<uint8_t>(k) = pictures[i].pixels[4 * size_t(k) + 3] >= 128 ? 255 : 0;
      masks.push_back(mask);
      seeing += cv::countNonZero(mask) > 0;
    }
    if (seeing < 3) return {};
    agreed_ = sequence.name;
    const auto why = mattes::disagreement(cameras, masks);
    if (!why) return {};
    return Error{ErrorId::InvalidArgument,
                 sequence.folder + ", frame " + std::to_string(frame) + ": " + *why +
                     "; check that camera's matte, calibration and synchronisation, leave it out (--leave-out NAME), "
                     "or go on all the same (--any-silhouettes; --mattes-alone: cameras do not help each other)"};
  }

  // The frame to go on with: stereo keeps surfaces steady, so that they depend on the frames before them in a window.
  uint32_t firstToMake(const capture::CaptureSequence& sequence) const {
    uint32_t frame = 0;
    while (frame < sequence.frame_count && store_->find(sequence.name, frame)) ++frame;
    if (frame == sequence.frame_count || !options_.stereo) return frame;
    return frame / kWindow * kWindow;
  }

  // A frame that an earlier run finished, drawn for the report.
  Status showKept(const capture::CaptureSequence& sequence, uint32_t frame, capture::FrameReader& reader,
                  ReportPictures& pictures) const {
    reader.skipTo(frame);
    FOURDVT_ASSIGN(const auto captured, reader.next());
    FrameSurface surface;
    FOURDVT_ASSIGN(surface.mesh, store_->loadMesh(sequence.name, frame));
    surface.silhouettes = silhouettesOf(cameras_, captured.pictures);
    pictures.add(sequence.name, frame, captured.pictures, surface);
    return {};
  }

  Result<std::vector<FrameFigures>> runSequence(const capture::CaptureSequence& sequence, SurfaceMaker& maker,
                                                ReportPictures& pictures) {
    FOURDVT_TRY(store_->makeFolders(sequence.name));
    FOURDVT_ASSIGN(auto reader,
                   capture::FrameReader::open(linked_, *linked_.find(sequence.name), environment_.open_video));
    std::vector<FrameFigures> out;
    const auto earliest = store_->find(sequence.name, 0);
    if (earliest) agreed_ = sequence.name;
    FOURDVT_TRY(maker.begin(earliest ? &*earliest : nullptr));
    const uint32_t first = firstToMake(sequence), shown = sequence.frame_count / 2;
    for (uint32_t frame = 0; frame < sequence.frame_count; ++frame) {
      if (frame < first) {
        if (frame == shown) FOURDVT_TRY(showKept(sequence, frame, *reader, pictures));
        out.push_back(*store_->find(sequence.name, frame));
        ++kept_, ++done_;
        continue;
      }
      if (environment_.stop && *environment_.stop) {
        return Error{ErrorId::Interrupted,
                     "stopped; finished frames are kept in " + folder_.partFolder() + " for --resume"};
      }
      const auto begun = Clock::now();
      reader->skipTo(frame);
      FOURDVT_ASSIGN(const auto captured, reader->next());
      const double read_ms = since(begun) * 1e3;
      FOURDVT_TRY(checkAgreement(sequence, frame, captured.pictures));
      if (frame % kWindow == 0) maker.forget();
      auto surface = maker.make(captured.pictures);
      if (!surface.ok()) {
        return Error{surface.error().id, sequence.folder + ", frame " + std::to_string(frame) + ": " +
                                             surface.error().message + "; finished frames are kept for --resume"};
      }
      FrameFigures& figures = surface.value().figures;
      figures.read_ms = read_ms;
      if (frame == shown) pictures.add(sequence.name, frame, captured.pictures, surface.value());
      FOURDVT_TRY(store_->save(sequence.name, frame, surface.value().mesh, figures));
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
  capture::Capture capture_;  // the given one; later with the new one's cameras and times
  const bool wants_mattes_;
  capture::Capture linked_;  // the new folder, where mattes are
  std::string agreed_;       // name of the last sequence whose silhouettes were judged
  std::vector<std::string> warnings_;
  std::optional<refine::Calibration> calibration_;  // made by this run
  capture::ResultFolder folder_;
  const FrameStore* store_ = nullptr;
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
  FOURDVT_ASSIGN(options.folder, capture::checkedTarget(given.folder, given.capture_folder, kWriter));
  std::optional<tbb::global_control> threads;  // OpenVDB's; the others are OpenCV's
  if (options.jobs > 0) {
    cv::setNumThreads(options.jobs);
    threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.jobs));
  }
  const auto open = [&](capture::MatteNeed need) {
    return capture::openCapture(options.capture_folder, environment.open_video, options.sequences,
                                capture::MeshNeed::Nothing, need);
  };
  FOURDVT_ASSIGN(auto capture, open(capture::MatteNeed::None));
  FOURDVT_TRY(capture::leaveOut(options.leave_out, capture));
  FOURDVT_ASSIGN(const bool wants_mattes, mattes::wantsMattes(capture));
  if (!wants_mattes && options.leave_out.empty()) {  // names bad mattes by the user's own files
    const auto with_mattes = open(capture::MatteNeed::Required);
    if (!with_mattes.ok()) return with_mattes.error();
  }
  return Run(options, environment, capture, wants_mattes).run();
}

}  // namespace fourdvt::reconstruct
