// SPDX-License-Identifier: Apache-2.0
#include "refine/run/calibrate_capture.h"

#include <opencv2/core/utility.hpp>

#include "capture/folder/linked_capture.h"
#include "capture/folder/result_folder.h"
#include "mattes/frame_reader.h"
#include "refine/run/calibration_report.h"

namespace fourdvt::refine {
namespace {

const capture::FolderWriter kWriter{"calibrate", kCalibrationJson, "reconstruct.json"};

Status writeCapture(const CalibrateOptions& options, const std::string& target, const capture::Capture& capture,
                    const Calibration& calibration) {
  const capture::ResultFolder folder(target, kWriter);
  FOURDVT_TRY(folder.open(capture::inputsKey(capture) + " calibrate 1\n", false));
  std::vector<std::string> names;
  for (const capture::CaptureSequence& s : capture.sequences) names.push_back(s.name);
  capture::LinkOptions link;
  link.sequences = names;
  link.leave_out = options.leave_out;
  link.own_calibration = link.own_times = true;
  FOURDVT_TRY(capture::linkCapture(capture, folder.partFolder(), link));
  FOURDVT_TRY(writeCalibrationReport(folder.partFolder(), options.capture_folder, calibration));
  return folder.finish();
}

}  // namespace

Result<Calibration> calibrateCapture(const CalibrateOptions& options, const OpenVideo& open_video,
                                     const std::function<bool(const std::string& what, double share)>& on_progress) {
  std::string target;
  if (!options.folder.empty()) {
    FOURDVT_ASSIGN(target, capture::checkedTarget(options.folder, options.capture_folder, kWriter));
  }
  if (options.jobs > 0) cv::setNumThreads(options.jobs);
  // Meshes go along as they are: none is read here.
  FOURDVT_ASSIGN(auto capture, mattes::openCapture(options.capture_folder, open_video, options.sequences,
                                                   capture::MeshNeed::Nothing));
  FOURDVT_TRY(capture::leaveOut(options.leave_out, capture));
  FOURDVT_ASSIGN(auto calibration, calibrate(capture, open_video, options.calibration, on_progress));
  if (target.empty()) return calibration;
  applyCalibration(calibration, capture);
  FOURDVT_TRY(writeCapture(options, target, capture, calibration));
  return calibration;
}

}  // namespace fourdvt::refine
