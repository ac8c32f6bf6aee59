// SPDX-License-Identifier: Apache-2.0
#include "mattes/run/report.h"

#include <algorithm>
#include <filesystem>

#include "base/text.h"
#include "capture/pictures.h"
#include "platform/files.h"
#include "report/document.h"
#include "report/picture_sheets.h"
#include "report/values.h"

namespace fourdvt::mattes {
namespace {

using report::fixedText, report::Json, report::Values;

constexpr double kContradicted = 0.15;  // mean share of a camera's own key that triggers a warning
constexpr double kShift_pixels = 3;
constexpr size_t kColumns = 10;  // cells side by side in a contact sheet

// Statistics of a camera's figure over the frames of a sequence.
struct Spread {
  double mean = 0, low = 1e30, high = -1e30;
  uint32_t low_frame = 0;
};
Spread spreadOf(const SequenceFigures& s, size_t camera, double CameraFigures::*figure) {
  Spread out;
  for (size_t i = 0; i < s.frames.size(); ++i) {
    const double value = s.frames[i][camera].*figure;
    out.mean += value / double(s.frames.size());
    if (value < out.low) out.low = value, out.low_frame = s.numbers[i];
    out.high = std::max(out.high, value);
  }
  return out;
}

report::Table cameraTable(const capture::Capture& capture, const SequenceFigures& s,
                          const std::vector<std::string>& sources) {
  std::vector<Values> rows;
  for (size_t c = 0; c < capture.cameras.size(); ++c) {
    const auto spread = [&](double CameraFigures::*figure) { return spreadOf(s, c, figure); };
    const Spread gain = spread(&CameraFigures::gain), supported = spread(&CameraFigures::supported);
    rows.push_back({{"", "camera", capture.cameras[c].pinhole.name},
                    {"", "from", sources[c]},
                    {"", "plate shift, most", fixedText(spread(&CameraFigures::shift_pixels).high, 2) + " px"},
                    {"", "gain", fixedText(gain.low, 3) + " to " + fixedText(gain.high, 3)},
                    {"", "explained, mean", supported.mean, 3},
                    {"", "lowest", fixedText(supported.low, 3) + " (" + std::to_string(supported.low_frame) + ")"},
                    {"", "kept, mean", spread(&CameraFigures::kept).mean, 3},
                    {"", "of the picture", report::percentText(100 * spread(&CameraFigures::share).mean)}});
  }
  return report::tableOf(
      s.name,
      "Plate shift and gain: how far plate and picture are apart, and were fitted. Explained: share of the camera's "
      "own key that no other camera contradicts; the rest is seen by this camera alone (somebody in the background, a "
      "screen, a reflection), or missing in the matte of another. Kept: share of the camera's own key in the matte.",
      rows);
}

// Cells of one camera side by side; empty without any.
Result<Image> sheetOf(const std::string& folder, const std::string& title) {
  const auto files = capture::sortedEntries(folder);
  if (files.empty()) return Image();
  report::Sheet sheet{title + ", frames", {}, {}, {}};
  for (const std::filesystem::path& file : files) {
    FOURDVT_ASSIGN(auto cell, platform::readImage(file.string()));
    const std::string number = std::to_string(std::stoul(file.stem().string()));
    if (sheet.cells.empty() || sheet.cells.back().size() == kColumns) {
      sheet.cells.emplace_back();
      sheet.rows.emplace_back();
    }
    sheet.rows.back() += (sheet.rows.back().empty() ? "" : " ") + number;
    if (sheet.columns.size() < kColumns) sheet.columns.emplace_back();
    sheet.cells.back().push_back(std::move(cell));
  }
  if (sheet.cells.size() > 1) return report::drawSheet(sheet);
  sheet.rows.clear();
  for (size_t i = 0; i < files.size(); ++i)
    sheet.columns[i] = "frame " + std::to_string(std::stoul(files[i].stem().string()));
  sheet.title = title;
  return report::drawSheet(sheet);
}

Json framesOf(const SequenceFigures& s) {
  Json frames = Json::array();
  for (size_t i = 0; i < s.frames.size(); ++i) {
    const auto cameras = report::rowsOf(s.frames[i], [](const CameraFigures& f) {
      return Values{{"shift_pixels", f.shift_pixels}, {"gain", f.gain}, {"residual_levels", f.residual_levels},
                    {"explained", f.supported},       {"kept", f.kept}, {"share", f.share}};
    });
    frames.push_back({{"frame", s.numbers[i]}, {"cameras", report::jsonOf(cameras)}});
  }
  return frames;
}

Values valuesOf(const capture::Capture& capture, const MattesOptions& options, const MattesSummary& summary) {
  const uint32_t made = summary.frames - summary.frames_kept;
  Json cameras = Json::array();
  for (size_t c = 0; c < capture.cameras.size(); ++c)
    cameras.push_back({{"name", capture.cameras[c].pinhole.name}, {"from", summary.sources[c]}});
  return {{"generator", "fourdvt mattes"},
          {"options/alone", options.alone},
          {"options/any_silhouettes", options.any_silhouettes},
          {"options/preview", options.preview},
          {"frames", "frames", summary.frames},
          {"frames_of_an_earlier_run", summary.frames_kept},
          {"cameras", "cameras", cameras, std::to_string(cameras.size())},
          {"wall_s", "a frame of all cameras", summary.wall_s, made ? fixedText(summary.wall_s / made, 2) + " s" : "–"},
          {"warnings", summary.warnings}};
}

}  // namespace

std::vector<std::string> warningsOf(const capture::Capture& capture, const MattesSummary& summary) {
  std::vector<std::string> out;
  for (const SequenceFigures& s : summary.sequences)
    for (size_t c = 0; c < capture.cameras.size(); ++c) {
      const std::string camera = s.name + ", camera \"" + capture.cameras[c].pinhole.name + "\"";
      const Spread supported = spreadOf(s, c, &CameraFigures::supported);
      if (1 - supported.mean > kContradicted)
        out.push_back(camera + " (" + fixedText(100 * (1 - supported.mean), 0) + " %, most in frame " +
                      std::to_string(supported.low_frame) +
                      "): had that much in its own key that the other cameras contradict; look at the red in its "
                      "contact sheet");
      const Spread shift = spreadOf(s, c, &CameraFigures::shift_pixels);
      if (shift.high > kShift_pixels)
        out.push_back(camera + " (" + fixedText(shift.high, 1) +
                      " pixels): stands up to so far off its plate; it was moved after its plate was taken, or after "
                      "its calibration: calibrate it again");
      if (spreadOf(s, c, &CameraFigures::share).high == 0)
        out.push_back(camera + ": sees nothing of the performer; check its plate and where it looks");
    }
  if (std::all_of(summary.sources.begin(), summary.sources.end(),
                  [](const std::string& s) { return s == kGivenMattes; }))
    out.push_back("all cameras have mattes already: none were made, and the report shows those");
  for (size_t c = 0; c < capture.cameras.size(); ++c)
    if (summary.sources[c] == "clips")
      out.push_back("camera \"" + capture.cameras[c].pinhole.name +
                    "\": has no plate, so that its background was made from its clips, which is a guess; look at its "
                    "contact sheet, and paint hints where it is wrong");
  return joinedWarnings(out);
}

Status writeReport(const std::string& folder, const std::string& cells_folder, const capture::Capture& capture,
                   const MattesOptions& options, const MattesSummary& summary) {
  const Values values = valuesOf(capture, options, summary);
  report::Section overview{.id = "overview", .title = "Overview"};
  for (const std::string& warning : summary.warnings) overview.text += warning + ".\n\n";
  overview.tiles = report::tilesOf(values);
  for (const SequenceFigures& s : summary.sequences)
    overview.tables.push_back(cameraTable(capture, s, summary.sources));

  report::Section sheets{
      "sheets", "Contact sheets",
      "Above: the picture, dark outside of the matte. Green: the matte's outline. Red: this camera's "
      "key had it, and other cameras contradict it. Blue: it lies on the floor as a whole, a shadow. "
      "Yellow: dropped for another reason. Below: the performer alone, on a colour that shows holes "
      "and fringes.\n\nWhere a matte is wrong, paint white on what is performer and black on what is "
      "background in a transparent picture of the frame's size, `hints/SEQUENCE/CAMERA/000000.png` "
      "in the capture, named after the first frame that is wrong, and make the mattes again."};
  size_t number = 0;
  for (const SequenceFigures& s : summary.sequences)
    for (const capture::CaptureCamera& camera : capture.cameras) {
      const std::string title = s.name + ", " + camera.pinhole.name;
      FOURDVT_ASSIGN(const Image picture, sheetOf(cells_folder + "/" + s.name + "/" + camera.pinhole.name, title));
      if (picture.empty()) continue;
      const std::string file = "mattes-" + std::to_string(++number) + ".jpg";
      FOURDVT_TRY(platform::writeImage(folder + "/" + file, picture));
      sheets.pictures.push_back({file, title, picture.width, picture.height});
    }
  report::Document page{capture.name + ", mattes", options.alone ? "every camera by itself" : "cameras together"};
  page.credit = capture.credit;
  page.sections = {std::move(overview), std::move(sheets)};
  Json json = report::jsonOf(values);
  for (const SequenceFigures& s : summary.sequences) json["sequences"][s.name] = framesOf(s);
  return report::writeReport(folder, "mattes", page, json);
}

}  // namespace fourdvt::mattes
