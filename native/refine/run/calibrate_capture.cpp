// SPDX-License-Identifier: Apache-2.0
#include "refine/run/calibrate_capture.h"

#include <filesystem>
#include <opencv2/core/utility.hpp>

#include "capture/folder/linked_capture.h"
#include "capture/folder/result_folder.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"
#include "report/document.h"
#include "report/values.h"

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
  // Meshes are linked unread.
  FOURDVT_ASSIGN(auto capture, mattes::openCapture(options.capture_folder, open_video, options.sequences,
                                                   capture::MeshNeed::Nothing));
  FOURDVT_TRY(capture::leaveOut(options.leave_out, capture));
  FOURDVT_ASSIGN(auto calibration, calibrate(capture, open_video, options.calibration, on_progress));
  if (target.empty()) return calibration;
  applyCalibration(calibration, capture);
  FOURDVT_TRY(writeCapture(options, target, capture, calibration));
  return calibration;
}

namespace {

using report::fixedText, report::Json, report::Values;

std::string withDeviation(double value, double deviation, int decimals) {
  return fixedText(value, decimals) + " ± " + fixedText(deviation, decimals);
}

Json jsonOf(const StickOut& s) {
  return {{"points", s.points}, {"mean_pixels", s.mean_pixels}, {"far_share", s.far_share}};
}

Json timesOf(const Calibration& calibration, const CameraCalibration& c) {
  Json times = Json::object();
  for (size_t s = 0; s < calibration.sequences.size(); ++s)
    if (c.times[s].known)
      times[calibration.sequences[s]] = {{"frames", c.times[s].offset_frames},
                                         {"deviation_frames", c.times[s].deviation_frames},
                                         {"changed", bool(c.time_changed[s])}};
  return times;
}

Values valuesOf(const Calibration& calibration, const CameraCalibration& c) {
  const glm::dvec3 &turn = c.turn_deg, &deviation = c.turn_deviation_deg;
  const std::string turned = c.unexplained ? "no pose fits"
                             : c.turned    ? withDeviation(glm::length(turn), glm::length(deviation), 3) + "°"
                                           : "–";
  Values out{{"name", "camera", c.name},
             {"outside_before", "outside before", jsonOf(c.before), fixedText(c.before.mean_pixels, 2) + " px"},
             {"", "far", report::percentText(100 * c.before.far_share)},
             {"outside_after", "after", jsonOf(c.after), fixedText(c.after.mean_pixels, 2) + " px"},
             {"", "far", report::percentText(100 * c.after.far_share)}};
  if (c.shift)
    append(out, {{"best_shift_pixels", "best change", c.shift->pixels,
                  withDeviation(c.shift->pixels, c.shift->deviation_pixels, 2) + " px"},
                 {"best_shift_deviation_pixels", c.shift->deviation_pixels}});
  else
    out.push_back({"", "best change", "–"});
  append(out, {{"turned", "turned by", c.turned, turned},
               {"turn_deg", {turn.x, turn.y, turn.z}},
               {"turn_deviation_deg", {deviation.x, deviation.y, deviation.z}},
               {"times", timesOf(calibration, c)},
               {"unexplained", c.unexplained}});
  return out;
}

report::Table placesTable(const std::vector<Values>& cameras) {
  return report::tableOf(
      "Cameras",
      "Outside: how far a camera's outlines stick out of the visual hull of all others, mean over the outline, and the "
      "share of it that does by more than 2 pixels. Best change: the turn that would fit best, as the shift of the "
      "outline in the picture with its standard deviation; a camera is turned only where that is clearly more than "
      "chance.",
      cameras);
}

report::Table timesTable(const Calibration& calibration) {
  const auto rows = report::rowsOf(calibration.by_camera, [&](const CameraCalibration& c) {
    Values row{{"", "camera", c.name}};
    for (size_t s = 0; s < calibration.sequences.size(); ++s) {
      const CameraTime& time = c.times[s];
      row.push_back({"", calibration.sequences[s],
                     !time.known ? "–"
                                 : withDeviation(time.offset_frames, time.deviation_frames, 2) +
                                       (c.time_changed[s] ? " (set)" : "")});
    }
    return row;
  });
  return report::tableOf("Times",
                         "Frames by which a camera's pictures come after those of the median camera, with the standard "
                         "deviation; set: written as \"offset_frames\". The nearest picture is what is read.",
                         rows);
}

report::BarChart outside(const Calibration& calibration) {
  report::BarChart chart{"Outlines outside of the others' hull, before and after", {}};
  for (const CameraCalibration& c : calibration.by_camera) {
    chart.bars.push_back({c.name, fixedText(c.before.mean_pixels, 2) + " px", c.before.mean_pixels});
    chart.bars.push_back({"after", fixedText(c.after.mean_pixels, 2) + " px", c.after.mean_pixels});
  }
  return chart;
}

Status addPictures(const std::string& folder, const CalibrationPicture& worst, report::Section& section) {
  const std::string where = worst.camera + ", frame " + std::to_string(worst.frame) + " of " + worst.sequence;
  const struct {
    const char* file;
    const Image& picture;
    const char* when;
  } both[] = {{"calibrate-before.jpg", worst.before, "before"}, {"calibrate-after.jpg", worst.after, "after"}};
  for (const auto& [file, picture, when] : both) {
    FOURDVT_TRY(platform::writeImage(folder + "/" + file, picture));
    section.pictures.push_back({file,
                                where + ", " + when +
                                    ": the rim of the other cameras' hull. Green: on the camera's own outline; red: "
                                    "outside of it, as it may be; blue: inside, so that something is wrong.",
                                picture.width, picture.height});
  }
  return {};
}

}  // namespace

std::vector<std::string> calibrationLines(const Calibration& calibration) {
  std::vector<std::string> out;
  for (const CameraCalibration& c : calibration.by_camera) {
    std::string times;
    for (size_t s = 0; s < calibration.sequences.size(); ++s)
      if (c.time_changed[s])
        times += (times.empty() ? "" : ", ") + withDeviation(c.times[s].offset_frames, c.times[s].deviation_frames, 2) +
                 " frames in \"" + calibration.sequences[s] + "\"";
    if (!times.empty()) out.push_back(c.name + " is off by " + times);
    if (c.turned)
      out.push_back(c.name + " was turned by " +
                    withDeviation(glm::length(c.turn_deg), glm::length(c.turn_deviation_deg), 3) + "°: outlines " +
                    fixedText(c.before.mean_pixels, 2) + " → " + fixedText(c.after.mean_pixels, 2) +
                    " pixels outside of the other cameras' hull");
  }
  if (out.empty())
    out.push_back(calibration.warnings.empty() ? "no camera is clearly off in time or place" : "no camera was changed");
  return out;
}

Status writeCalibrationReport(const std::string& folder, const std::string& name, const Calibration& calibration) {
  report::Section section{"cameras", "In step and in place"};
  for (const std::string& line : calibrationLines(calibration)) section.text += line + ".\n\n";
  for (const std::string& warning : calibration.warnings) section.text += "Warning: " + warning + ".\n\n";
  const auto cameras =
      report::rowsOf(calibration.by_camera, [&](const CameraCalibration& c) { return valuesOf(calibration, c); });
  section.tables = {placesTable(cameras), timesTable(calibration)};
  section.bar_charts = {outside(calibration)};
  if (calibration.worst) FOURDVT_TRY(addPictures(folder, *calibration.worst, section));
  const report::Document page{"Calibration of " + std::filesystem::path(name + "/").parent_path().filename().string(),
                              std::to_string(calibration.by_camera.size()) + " cameras, " +
                                  std::to_string(calibration.frames) + " frames looked at",
                              {std::move(section)}};
  return report::writeReport(
      folder, "calibrate", page,
      {{"frames", calibration.frames}, {"cameras", report::jsonOf(cameras)}, {"warnings", calibration.warnings}});
}

}  // namespace fourdvt::refine
