// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/prepare.h"

#include <tbb/global_control.h>

#include <filesystem>
#include <opencv2/core/utility.hpp>

#include "capture/folder/linked_capture.h"
#include "jobs/job_file.h"
#include "mattes/frame_reader.h"
#include "mattes/run/matte_sources.h"
#include "mattes/run/mattes.h"
#include "reconstruct/run/report.h"
#include "reconstruct/run/sequence_frames.h"
#include "refine/run/calibrate_capture.h"

namespace fourdvt::reconstruct {
namespace {

const capture::FolderWriter kWriter{"reconstruct", kReportJson, ""};
constexpr size_t kMinCalibrated = 4;  // cameras; the silhouettes of fewer hardly contradict each other

}  // namespace

struct Threads::Limit {
  tbb::global_control threads;  // OpenVDB's threads; OpenCV has its own
};

Threads::Threads(int count) {
  if (count <= 0) return;
  cv::setNumThreads(count);
  limit_.reset(new Limit{{tbb::global_control::max_allowed_parallelism, size_t(count)}});
}

Threads::~Threads() = default;

capture::ResultFolder resultFolder(const ReconstructOptions& options) { return {options.folder, kWriter}; }

Status Preparation::openGiven() {
  ReconstructOptions& options = out_.options;
  FOURDVT_ASSIGN(options.folder, capture::checkedTarget(options.folder, options.capture_folder, kWriter));
  const auto open = [&](capture::MatteNeed need) {
    return mattes::openCapture(options.capture_folder, environment_.open_video, options.sequences,
                               capture::MeshNeed::Nothing, need);
  };
  FOURDVT_ASSIGN(given_, open(capture::MatteNeed::None));
  FOURDVT_TRY(capture::leaveOut(options.leave_out, given_));
  FOURDVT_ASSIGN(wants_mattes_, mattes::wantsMattes(given_, environment_.open_video));
  if (!wants_mattes_ && options.leave_out.empty()) {  // messages about bad mattes name the user's own files
    const auto with_mattes = open(capture::MatteNeed::Required);
    if (!with_mattes.ok()) return with_mattes.error();
  }
  options.capture_folder = given_.folder;
  options.sequences.clear();
  for (const capture::CaptureSequence& sequence : given_.sequences) options.sequences.push_back(sequence.name);
  out_.name = given_.name;
  out_.settings_key = settingsKey(options, given_);
  return {};
}

Status Preparation::link(Earlier earlier) {
  FOURDVT_TRY(openGiven());
  const capture::ResultFolder folder = resultFolder(out_.options);
  FOURDVT_ASSIGN(out_.settings_key, folder.openFor(out_.settings_key, earlier, environment_.note));
  FOURDVT_TRY(linkFrames());
  FOURDVT_ASSIGN(out_.capture, mattes::openLinked(folder.partFolder(), out_.options.capture_folder,
                                                  out_.options.sequences, environment_.open_video));
  capture::Capture& linked = out_.capture;
  linked.name = given_.name;
  for (size_t c = 0; c < given_.cameras.size(); ++c) given_.cameras[c].pinhole = linked.cameras[c].pinhole;
  for (size_t s = 0; s < given_.sequences.size(); ++s) {
    capture::CaptureSequence& here = given_.sequences[s];
    const capture::CaptureSequence& there = linked.sequences[s];
    here.frame_count = there.frame_count, here.first_frame = there.first_frame;
    here.offset_frames = there.offset_frames, here.test_frames = there.test_frames;
  }
  return {};
}

// Links the new folder to all inputs that are not computed; keeps the calibration of an earlier run.
Status Preparation::linkFrames() {
  const ReconstructOptions& options = out_.options;
  const std::string part = resultFolder(options).partFolder();
  std::error_code none;
  const bool calibrates = options.synchronise || options.refine_cameras;
  if (calibrates && std::filesystem::exists(part + "/" + refine::kCalibrationJson, none)) return {};
  if (calibrates) FOURDVT_TRY(calibrate());
  capture::LinkOptions link;
  link.sequences = options.sequences;
  link.meshes = capture::LinkedMeshes::PerFrame;
  link.leave_out = options.leave_out;
  link.own_calibration = link.own_times = calibration_ && calibration_->changed();
  FOURDVT_TRY(capture::linkCapture(given_, part, link));
  if (!calibration_) return {};
  return refine::writeCalibrationReport(part, given_folder_, *calibration_);
}

// Calibrates and synchronises cameras with silhouettes that each camera has by itself: mattes computed jointly already
// agree with each other.
Status Preparation::calibrate() {
  if (given_.cameras.size() < kMinCalibrated) return {};
  refine::CalibrationOptions options;
  options.times = out_.options.synchronise, options.cameras = out_.options.refine_cameras;
  const auto found = refine::calibrate(given_, environment_.open_video, options, [&](const std::string& what, double) {
    if (environment_.progress) environment_.progress({"calibrating: " + what, 0, 0, 0, 0});
    return !environment_.stop || !*environment_.stop;
  });
  std::vector<std::string>& warnings = out_.warnings;
  if (!found.ok() && found.error().id == ErrorId::Interrupted) return found.error();
  if (!found.ok()) {
    warnings.push_back("cameras stay as given in time and place: " + found.error().message);
    return {};
  }
  calibration_ = found.value();
  refine::applyCalibration(*calibration_, given_);
  for (const std::string& line : refine::calibrationLines(*calibration_))
    if (calibration_->changed()) warnings.push_back(line);
  warnings.insert(warnings.end(), calibration_->warnings.begin(), calibration_->warnings.end());
  return {};
}

Status Preparation::addMattes() {
  if (!wants_mattes_) return {};
  mattes::MattesOptions options;
  options.alone = out_.options.mattes_alone;
  options.any_silhouettes = out_.options.any_silhouettes;
  const mattes::MattesEnvironment environment{environment_.open_video, environment_.progress, environment_.stop};
  const capture::ResultFolder folder = resultFolder(out_.options);
  FOURDVT_ASSIGN(const auto summary,
                 mattes::addMattes(given_, folder.partFolder(), folder.workFolder(), options, environment));
  out_.warnings.insert(out_.warnings.end(), summary.warnings.begin(), summary.warnings.end());
  return {};
}

}  // namespace fourdvt::reconstruct

namespace fourdvt::store {

// Options that determine frames and their report.
void fields(Archive& a, reconstruct::ReconstructOptions& o) {
  a(o.capture_folder, o.folder, o.sequences, o.leave_out, o.mattes_alone, o.any_silhouettes, o.synchronise,
    o.refine_cameras, o.hull, o.contour_tolerance_px, o.voxel_m, o.faces, o.adaptivity, o.stereo, o.planes, o.fairing);
}
void fields(Archive& a, reconstruct::JobFile& f) {
  a(f.job.options, f.job.settings_key, f.job.warnings, f.job.name, f.common_input_digest);
}

}  // namespace fourdvt::store

namespace fourdvt::reconstruct {

Status writeJobFile(const std::string& job_folder, const JobFile& file) { return jobs::writeJobFile(job_folder, file); }

Result<JobFile> readJobFile(const std::string& job_folder) { return jobs::readJobFile<JobFile>(job_folder); }

}  // namespace fourdvt::reconstruct
