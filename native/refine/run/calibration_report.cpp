// SPDX-License-Identifier: Apache-2.0
#include "refine/run/calibration_report.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "platform/files.h"
#include "refine/run/calibrate_capture.h"
#include "report/document.h"
#include "report/text.h"

namespace fourdvt::refine {
namespace {

using Json = nlohmann::ordered_json;
using report::fixedText;

std::string withDeviation(double value, double deviation, int decimals) {
  return fixedText(value, decimals) + " ± " + fixedText(deviation, decimals);
}

Json jsonOf(const StickOut& s) {
  return {{"points", s.points}, {"mean_pixels", s.mean_pixels}, {"far_share", s.far_share}};
}

Json jsonOf(const Calibration& calibration) {
  Json cameras = Json::array();
  for (const CameraCalibration& c : calibration.by_camera) {
    Json times = Json::object();
    for (size_t s = 0; s < calibration.sequences.size(); ++s) {
      if (!c.times[s].known) continue;
      times[calibration.sequences[s]] = {{"frames", c.times[s].offset_frames},
                                         {"deviation_frames", c.times[s].deviation_frames},
                                         {"changed", bool(c.time_changed[s])}};
    }
    Json camera = {{"name", c.name},
                   {"times", times},
                   {"turned", c.turned},
                   {"turn_deg", {c.turn_deg.x, c.turn_deg.y, c.turn_deg.z}},
                   {"turn_deviation_deg", {c.turn_deviation_deg.x, c.turn_deviation_deg.y, c.turn_deviation_deg.z}},
                   {"outside_before", jsonOf(c.before)},
                   {"outside_after", jsonOf(c.after)},
                   {"unexplained", c.unexplained}};
    if (c.shift) {
      camera["best_shift_pixels"] = c.shift->pixels;
      camera["best_shift_deviation_pixels"] = c.shift->deviation_pixels;
    }
    cameras.push_back(camera);
  }
  return {{"frames", calibration.frames}, {"cameras", cameras}, {"warnings", calibration.warnings}};
}

report::Table placesOf(const Calibration& calibration) {
  report::Table table{
      "Cameras",
      "Outside: how far a camera's outlines stick out of the visual hull of all others, mean over the outline, and the "
      "share of it that does by more than 2 pixels. Best change: the turn that would fit best, as the shift of the "
      "outline in the picture with its standard deviation; a camera is turned only where that is clearly more than "
      "chance.",
      {"camera", "outside before", "far", "after", "far", "best change", "turned by"},
      {}};
  for (const CameraCalibration& c : calibration.by_camera) {
    const std::string turned = c.unexplained ? "no pose fits"
                               : c.turned
                                   ? withDeviation(glm::length(c.turn_deg), glm::length(c.turn_deviation_deg), 3) + "°"
                                   : "–";
    table.rows.push_back(
        {c.name, fixedText(c.before.mean_pixels, 2) + " px", report::percentText(100 * c.before.far_share),
         fixedText(c.after.mean_pixels, 2) + " px", report::percentText(100 * c.after.far_share),
         c.shift ? withDeviation(c.shift->pixels, c.shift->deviation_pixels, 2) + " px" : "–", turned});
  }
  return table;
}

report::Table timesOf(const Calibration& calibration) {
  report::Table table{"Times",
                      "Frames by which a camera's pictures come after those of the median camera, with the standard "
                      "deviation; set: written as \"offset_frames\". The nearest picture is what is read.",
                      {"camera"},
                      {}};
  for (const std::string& sequence : calibration.sequences) table.columns.push_back(sequence);
  for (const CameraCalibration& c : calibration.by_camera) {
    std::vector<std::string> row{c.name};
    for (size_t s = 0; s < calibration.sequences.size(); ++s) {
      const CameraTime& time = c.times[s];
      row.push_back(!time.known ? "–"
                                : withDeviation(time.offset_frames, time.deviation_frames, 2) +
                                      (c.time_changed[s] ? " (set)" : ""));
    }
    table.rows.push_back(row);
  }
  return table;
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
  report::Document document;
  document.title = "Calibration of " + std::filesystem::path(name + "/").parent_path().filename().string();
  document.subtitle = std::to_string(calibration.by_camera.size()) + " cameras, " + std::to_string(calibration.frames) +
                      " frames looked at";
  report::Section section{"cameras", "In step and in place"};
  for (const std::string& line : calibrationLines(calibration)) section.text += line + ".\n\n";
  for (const std::string& warning : calibration.warnings) section.text += "Warning: " + warning + ".\n\n";
  section.tables = {placesOf(calibration), timesOf(calibration)};
  section.bar_charts = {outside(calibration)};
  if (calibration.worst) FOURDVT_TRY(addPictures(folder, *calibration.worst, section));
  document.sections.push_back(std::move(section));
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/" + kCalibrationJson, jsonOf(calibration).dump(2) + "\n"));
  return platform::writeFileAtomic(folder + "/" + kCalibrationHtml, report::documentHtml(document));
}

}  // namespace fourdvt::refine
