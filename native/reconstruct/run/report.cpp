// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "base/text.h"
#include "platform/files.h"
#include "reconstruct/run/silhouette_match.h"
#include "report/document.h"
#include "report/picture_sheets.h"
#include "report/values.h"

namespace fourdvt::reconstruct {
namespace {

using report::fixedText, report::Json, report::Values;

constexpr size_t kColumns = 8;     // cameras side by side
constexpr int kSheetHeight = 420;  // pixels of one picture
constexpr double kLowOverlap = 0.95;
constexpr double kMaxCover = 0.9, kMaxFilled = 0.7;  // above, mattes hardly have an outline
constexpr double kDeep_m = 0.03;  // normalised to a person: maximum colour-coded depth behind the hull

struct Stage {
  const char* name;
  double FrameFigures::*ms;
};
constexpr Stage kStages[] = {{"read", &FrameFigures::read_ms},       {"silhouettes", &FrameFigures::silhouettes_ms},
                             {"hull", &FrameFigures::hull_ms},       {"stereo", &FrameFigures::stereo_ms},
                             {"fairing", &FrameFigures::fairing_ms}, {"overlap", &FrameFigures::check_ms}};

template <class F>
double meanOver(const std::vector<ReconstructedSequence>& sequences, F value) {
  double sum = 0;
  size_t count = 0;
  for (const auto& s : sequences)
    for (const auto& f : s.frames) sum += value(f), ++count;
  return count ? sum / double(count) : 0;
}

struct Overlap {
  double mean = 0, lowest = 1;
  uint32_t lowest_frame = 0;
  size_t frames = 0, empty = 0;
  uint32_t first_empty = 0;
};

Overlap overlapOf(const ReconstructedSequence& sequence, size_t camera) {
  Overlap out;
  for (uint32_t frame = 0; frame < sequence.frames.size(); ++frame) {
    const double value = sequence.frames[frame].overlap.at(camera);
    if (std::isnan(value)) {
      if (out.empty++ == 0) out.first_empty = frame;
      continue;
    }
    out.mean += value;
    ++out.frames;
    if (value < out.lowest) out.lowest = value, out.lowest_frame = frame;
  }
  if (out.frames) out.mean /= double(out.frames);
  return out;
}

// One row per camera: its name, then the output of `add`.
template <class Add>
std::vector<Values> cameraRows(const capture::Capture& capture, Add add) {
  std::vector<Values> rows;
  for (size_t camera = 0; camera < capture.cameras.size(); ++camera) {
    rows.push_back({{"", "camera", capture.cameras[camera].pinhole.name}});
    add(camera, rows.back());
  }
  return rows;
}

report::Table overlapTable(const capture::Capture& capture, const std::vector<ReconstructedSequence>& sequences) {
  const auto rows = cameraRows(capture, [&](size_t camera, Values& row) {
    for (const auto& s : sequences) {
      const Overlap o = overlapOf(s, camera);
      const std::string lowest = fixedText(o.lowest, 4) + " (" + std::to_string(o.lowest_frame) + ")";
      append(row,
             {{"", s.name + ", mean", o.frames ? fixedText(o.mean, 4) : "–"}, {"", "lowest", o.frames ? lowest : "–"}});
    }
  });
  return report::tableOf("Overlap of surface and silhouette",
                         "Intersection over union of the drawn surface and the silhouette: mean over the frames, and "
                         "the lowest with its frame. 1 is perfect; a camera that stands out is calibrated, keyed or "
                         "synchronised worse than the others.",
                         rows);
}

// Mean over the frames with a value; NaN: none.
double meanOf(const ReconstructedSequence& sequence, std::vector<double> FrameFigures::*list, size_t camera) {
  double sum = 0;
  size_t count = 0;
  for (const FrameFigures& f : sequence.frames)
    if (camera < (f.*list).size() && !std::isnan((f.*list)[camera])) sum += (f.*list)[camera], ++count;
  return count ? sum / double(count) : std::numeric_limits<double>::quiet_NaN();
}

// Three significant digits, for volumes from figurines to halls.
std::string volumeText(double m3) { return printed("%.3g m³", m3); }

// Share of the space seen by more than half of the cameras; 0: unknown.
double filledShare(const ReconstructedSequence& sequence) {
  double sum = 0, seen = 0;
  for (const FrameFigures& f : sequence.frames) sum += f.volume_m3, seen += f.seen_m3;
  return seen > 0 ? sum / seen : 0;
}

report::Table coverTable(const capture::Capture& capture, const std::vector<ReconstructedSequence>& sequences) {
  auto rows = cameraRows(capture, [&](size_t camera, Values& row) {
    for (const auto& s : sequences) {
      const double cover = meanOf(s, &FrameFigures::cover, camera);
      row.push_back({"", s.name, std::isnan(cover) ? "–" : fixedText(100 * cover, 1) + " %"});
    }
  });
  Values volumes{{"", "camera", "volume of the surface"}}, shares{{"", "camera", "of the space seen"}};
  for (const auto& s : sequences) {
    volumes.push_back({"", s.name, volumeText(meanOver({s}, [](const FrameFigures& f) { return f.volume_m3; }))});
    shares.push_back({"", s.name, fixedText(100 * filledShare(s), 1) + " %"});
  }
  rows.push_back(std::move(volumes));
  rows.push_back(std::move(shares));
  return report::tableOf(
      "Cover and volume",
      "Share of the camera's picture that its silhouette covers, mean over the frames; and the surface's "
      "volume, mean over the frames, with its share of the space that more than half of the cameras "
      "see. Where mattes cover nearly all, overlap says nothing: the surface is what the cameras see.",
      rows);
}

// Warnings about silhouettes or a surface that fill nearly all of the available space.
std::vector<std::string> coverWarnings(const capture::Capture& capture, const ReconstructedSequence& s) {
  std::vector<std::string> out;
  for (size_t camera = 0; camera < capture.cameras.size(); ++camera)
    if (const double cover = meanOf(s, &FrameFigures::cover, camera); cover > kMaxCover)
      out.push_back(s.name + ", camera \"" + capture.cameras[camera].pinhole.name + "\" (" + fixedText(100 * cover, 0) +
                    " %): the mattes cover nearly the whole picture, so that overlap says nothing; check them, white "
                    "is the object");
  if (const double share = filledShare(s); share > kMaxFilled)
    out.push_back(s.name + ": the surface fills " + fixedText(100 * share, 0) + " % of the " +
                  volumeText(s.frames.front().seen_m3) +
                  " that more than half of the cameras see, as if mattes covered their pictures; check them, white is "
                  "the object");
  return out;
}

report::Table stereoTable(const capture::Capture& capture, const std::vector<ReconstructedSequence>& sequences) {
  std::vector<Values> rows;
  for (size_t camera = 0; camera < capture.cameras.size(); ++camera)
    for (const ReconstructedSequence& s : sequences) {
      const auto mean = [&](std::vector<double> FrameFigures::*list) { return meanOf(s, list, camera); };
      rows.push_back({{"", "camera", capture.cameras[camera].pinhole.name},
                      {"", "sequence", s.name},
                      {"", "believed", mean(&FrameFigures::believed), 3},
                      {"", "moved", mean(&FrameFigures::moved), 3},
                      {"", "hull stayed", 1 - mean(&FrameFigures::moved), 3},
                      {"", "overlap of the hull", mean(&FrameFigures::hull_overlap), 4},
                      {"", "overlap of the surface", mean(&FrameFigures::overlap), 4},
                      {"", "outline, pixels", mean(&FrameFigures::outline_px), 2}});
    }
  return report::tableOf(
      "What stereo changed",
      "Means over the frames. Believed: share of the hull in the camera's picture where its depths count, "
      "because there is texture and other cameras confirm them; a camera that stands out is calibrated or "
      "synchronised worse. Moved: share where the surface lies at least 3 mm of a person behind the hull; "
      "elsewhere the hull stayed. Outline: median distance of the silhouette's from the surface's, pixels.",
      rows);
}

// Millimetres with at least two significant digits, for a figurine's small voxels.
std::string millimetres(double metres) {
  const double mm = metres * 1e3;
  return fixedText(mm, mm >= 10 ? 0 : mm >= 1 ? 1 : mm >= 0.1 ? 2 : 3) + " mm";
}

Values sequenceValues(const ReconstructedSequence& s) {
  const auto mean = [&](auto count) { return meanOver({s}, [&](const FrameFigures& f) { return double(f.*count); }); };
  size_t fallbacks = 0, left_out = 0;
  for (const auto& f : s.frames) fallbacks += !f.fallback.empty(), left_out += f.parts_left_out;
  const FrameFigures first = s.frames.empty() ? FrameFigures{} : s.frames.front();
  return {{"", "sequence", s.name},
          {"", "frames", s.frames.size()},
          {"", "voxel", millimetres(first.voxel_m)},
          {"", "pixel on the performer", millimetres(first.footprint_m)},
          {"", "triangles made", mean(&FrameFigures::triangles_made), 0},
          {"", "triangles", mean(&FrameFigures::triangles), 0},
          {"", "vertices", mean(&FrameFigures::vertices), 0},
          {"", "parts left out", left_out},
          {"", "fallbacks", fallbacks}};
}

report::BarChart stageChart(const std::vector<ReconstructedSequence>& sequences) {
  report::BarChart chart{"Milliseconds a frame", {}};
  for (const Stage& stage : kStages) {
    const double ms = meanOver(sequences, [&](const FrameFigures& f) { return f.*stage.ms; });
    if (ms > 0) chart.bars.push_back({stage.name, fixedText(ms, 0) + " ms", ms});
  }
  return chart;
}

// One curve per sequence: `value` of its frames.
template <class F>
report::Plot plotOf(const std::string& title, const std::string& label,
                    const std::vector<ReconstructedSequence>& sequences, F value) {
  report::Plot plot{title, "frame", label};
  for (const auto& s : sequences) {
    report::Curve curve{s.name, {}};
    for (size_t i = 0; i < s.frames.size(); ++i) curve.points.push_back({double(i), value(s.frames[i])});
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

double lowestOverlap(const FrameFigures& f) {
  double lowest = 1;
  for (double v : f.overlap) lowest = v < lowest ? v : lowest;
  return lowest;
}

std::string hullText(const ReconstructOptions& o, const std::vector<ReconstructedSequence>& sequences) {
  if (o.hull == HullKind::Polyhedral)
    return "polyhedral hull, outlines within " + fixedText(o.contour_tolerance_px, 2) + " pixels";
  std::string text = "volumetric hull, voxels of ", last;
  for (const ReconstructedSequence& s : sequences) {
    if (s.frames.empty()) continue;
    const std::string voxel = millimetres(s.frames.front().voxel_m);
    if (voxel != last) text += (last.empty() ? "" : " and ") + voxel;
    last = voxel;
  }
  return text;
}

Values summaryValues(const ReconstructOptions& o, const ReconstructSummary& summary, double triangles) {
  return {{"generator", "fourdvt reconstruct"},
          {"options/hull", o.hull == HullKind::Polyhedral ? "polyhedral" : "volumetric"},
          {"options/contour_tolerance_px", o.contour_tolerance_px},
          {"options/voxel_mm", o.voxel_m > 0 ? Json(o.voxel_m * 1e3) : Json("auto")},
          {"options/faces", o.faces},
          {"options/adaptivity", o.adaptivity},
          {"options/refine", o.stereo ? "stereo" : "none"},
          {"options/planes", o.planes},
          {"options/fairing", o.fairing},
          {"mean_overlap", "mean overlap of surface and silhouettes", summary.mean_overlap, 4},
          {"lowest_overlap", "lowest overlap, any camera and frame", summary.lowest_overlap, 4},
          {"mean_cover", "of the pictures are covered by silhouettes", summary.mean_cover,
           fixedText(100 * summary.mean_cover, 1) + " %"},
          {"volume_m3", "volume of the surface, of " + volumeText(summary.seen_m3) + " that the cameras see",
           summary.volume_m3, volumeText(summary.volume_m3)},
          {"seen_m3", summary.seen_m3},
          {"", "triangles a frame", triangles, 0},
          {"frames", "frames", summary.frames},
          {"frames_of_an_earlier_run", summary.frames_kept},
          {"wall_s", summary.wall_s},
          {"warnings", summary.warnings}};
}

report::Section overviewSection(const ReconstructOptions& options, const capture::Capture& capture,
                                const std::vector<ReconstructedSequence>& sequences, const ReconstructSummary& summary,
                                const Values& values) {
  const auto triangles = [](const FrameFigures& f) { return double(f.triangles); };
  report::Section section{.id = "overview", .title = "Overview"};
  for (const std::string& warning : summary.warnings) section.text += warning + ".\n\n";
  section.tiles = report::tilesOf(values);
  section.tables = {report::tableOf("", "", report::rowsOf(sequences, sequenceValues)),
                    overlapTable(capture, sequences), coverTable(capture, sequences)};
  if (options.stereo) section.tables.push_back(stereoTable(capture, sequences));
  section.bar_charts = {stageChart(sequences)};
  section.plots = {plotOf("Lowest overlap of the cameras", "intersection over union", sequences, lowestOverlap),
                   plotOf("Triangles", "triangles", sequences, triangles)};
  return section;
}

Result<report::Section> picturesSection(const std::string& folder, bool stereo, const ReportPictures& pictures) {
  report::Section section{.id = "pictures", .title = "The surface over the pictures"};
  section.text =
      "Green: the outline of the surface. Red: the outline of the silhouette, where the two are apart. "
      "Below it the surface alone, as the camera sees it";
  section.text +=
      stereo ? ", and how far stereo moved it: grey, it is the hull; red, 30 mm of a person and more." : ".";
  for (size_t i = 0; i < pictures.sheets().size(); ++i) {
    const auto& sheet = pictures.sheets()[i];
    const std::string file = "reconstruct-" + std::to_string(i + 1) + ".jpg";
    FOURDVT_TRY(platform::writeImage(folder + "/" + file, sheet.picture));
    section.pictures.push_back(
        {file, sheet.sequence + ", frame " + std::to_string(sheet.frame), sheet.picture.width, sheet.picture.height});
  }
  return section;
}

}  // namespace

void ReportPictures::add(const std::string& sequence, uint32_t frame, std::span<const Image> pictures,
                         const FrameSurface& surface) {
  for (size_t first = 0; first < pictures.size(); first += kColumns) {
    report::Sheet sheet;
    sheet.title = sequence + ", frame " + std::to_string(frame);
    const bool refined = !surface.hull.faces.empty();
    sheet.cells.resize(refined ? 3 : 2);
    for (size_t i = first; i < std::min(pictures.size(), first + kColumns); ++i) {
      const SurfacePictures drawn = surfacePictures(surface.silhouettes[i], pictures[i], surface.mesh);
      sheet.columns.push_back(surface.silhouettes[i].camera.name);
      const int width = drawn.shaded.width * kSheetHeight / std::max(1, drawn.shaded.height);
      sheet.cells[0].push_back(report::scaledTo(drawn.over_picture, std::max(1, width), kSheetHeight));
      sheet.cells[1].push_back(report::scaledTo(drawn.shaded, std::max(1, width), kSheetHeight));
      if (!refined) continue;
      const Image moved = movedPicture(surface.silhouettes[i].camera, pictures[i], surface.hull, surface.mesh,
                                       kDeep_m * surface.figures.person_metre_m);
      sheet.cells[2].push_back(report::scaledTo(moved, std::max(1, width), kSheetHeight));
    }
    sheets_.push_back({sequence, frame, report::drawSheet(sheet)});
  }
}

ReconstructSummary summarise(const capture::Capture& capture, const std::vector<ReconstructedSequence>& sequences) {
  ReconstructSummary out;
  double sum = 0;
  size_t count = 0;
  out.volume_m3 = meanOver(sequences, [](const FrameFigures& f) { return f.volume_m3; });
  out.seen_m3 = meanOver(sequences, [](const FrameFigures& f) { return f.seen_m3; });
  out.mean_cover = meanOver(sequences, [](const FrameFigures& f) {
    return std::accumulate(f.cover.begin(), f.cover.end(), 0.0) / double(std::max<size_t>(1, f.cover.size()));
  });
  for (const auto& s : sequences) {
    const auto covers = coverWarnings(capture, s);
    out.warnings.insert(out.warnings.end(), covers.begin(), covers.end());
    out.frames += uint32_t(s.frames.size());
    size_t fallbacks = 0;
    std::string reason;  // first frame's reason
    for (const auto& f : s.frames) {
      if (!f.fallback.empty() && fallbacks++ == 0) reason = f.fallback;
    }
    if (fallbacks > 0) {
      out.warnings.push_back(s.name + ": the polyhedral hull failed its checks in " + std::to_string(fallbacks) +
                             " of " + std::to_string(s.frames.size()) + " frames (" + reason +
                             "); they have the volumetric one");
    }
    for (size_t camera = 0; camera < capture.cameras.size(); ++camera) {
      const Overlap o = overlapOf(s, camera);
      const std::string& name = capture.cameras[camera].pinhole.name;
      sum += o.mean * double(o.frames);
      count += o.frames;
      if (o.frames) out.lowest_overlap = std::min(out.lowest_overlap, o.lowest);
      const std::string camera_name = s.name + ", camera \"" + name + "\"";
      if (o.empty > 0) {
        out.warnings.push_back(camera_name + ": sees nothing of the performer in " + std::to_string(o.empty) + " of " +
                               std::to_string(s.frames.size()) + " frames (first " + std::to_string(o.first_empty) +
                               ") and is left out there; check its matte");
      }
      if (o.frames && o.mean < kLowOverlap) {
        out.warnings.push_back(camera_name + " (" + fixedText(100 * o.mean, 1) + " %): less than " +
                               fixedText(100 * kLowOverlap, 0) +
                               " % of the silhouette agrees with the surface; check calibration, matte and "
                               "synchronisation");
      }
    }
  }
  if (count) out.mean_overlap = sum / double(count);
  return out;
}

Result<ReconstructSummary> readSummary(const std::string& folder) {
  const std::string path = folder + "/" + kReportJson;
  FOURDVT_ASSIGN(const auto bytes, platform::readFile(path));
  const Json json = Json::parse(bytes.begin(), bytes.end(), nullptr, false);
  try {
    ReconstructSummary out;
    json.at("frames").get_to(out.frames);
    json.at("frames_of_an_earlier_run").get_to(out.frames_kept);
    json.at("wall_s").get_to(out.wall_s);
    json.at("mean_overlap").get_to(out.mean_overlap);
    json.at("lowest_overlap").get_to(out.lowest_overlap);
    json.at("mean_cover").get_to(out.mean_cover);
    json.at("volume_m3").get_to(out.volume_m3);
    json.at("seen_m3").get_to(out.seen_m3);
    json.at("warnings").get_to(out.warnings);
    return out;
  } catch (const std::exception&) {
    return Error{ErrorId::FileUnreadable, path + ": damaged; run the command again"};
  }
}

Status writeReport(const std::string& folder, const ReconstructOptions& options, const capture::Capture& capture,
                   const std::vector<ReconstructedSequence>& sequences, const ReportPictures& pictures,
                   const ReconstructSummary& summary) {
  const double triangles = meanOver(sequences, [](const FrameFigures& f) { return double(f.triangles); });
  const Values values = summaryValues(options, summary, triangles);
  report::Document page{capture.name + ", reconstructed",
                        hullText(options, sequences) + (options.stereo ? ", refined by stereo" : "")};
  page.credit = capture.credit;
  FOURDVT_ASSIGN(auto drawn, picturesSection(folder, options.stereo, pictures));
  page.sections = {overviewSection(options, capture, sequences, summary, values), std::move(drawn)};
  Json json = report::jsonOf(values);
  for (const auto& s : sequences)
    for (const auto& f : s.frames) json["sequences"][s.name].push_back(Json::parse(figuresText(f)));
  return report::writeReport(folder, "reconstruct", page, json);
}

}  // namespace fourdvt::reconstruct
