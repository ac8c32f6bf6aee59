// SPDX-License-Identifier: Apache-2.0
#include "track/run/report.h"

#include <algorithm>

#include "base/text.h"
#include "report/document.h"
#include "report/values.h"

namespace fourdvt::track {
namespace {

using report::fixedText, report::Json, report::Values;

Json jsonOf(const FitFigures& f) {
  return {{"overlap", f.overlap.mean},
          {"lowest_overlap", f.overlap.lowest},
          {"distance_95_mm", 1e3 * f.distance_95_m},
          {"distance_max_mm", 1e3 * f.distance_max_m},
          {"farthest_m", {f.farthest.x, f.farthest.y, f.farthest.z}},
          {"seen_share", f.seen_share},
          {"stretched_faces", f.stretched_faces},
          {"flipped_faces", f.flipped_faces},
          {"colour_error", f.colour_error}};
}

}  // namespace

void summarise(std::span<const TrackedSequence> sequences, TrackSummary& out) {
  for (const TrackedSequence& s : sequences) {
    out.frames += uint32_t(s.figures.size());
    out.interpolated += uint32_t(s.failures.size());
    for (const FitFigures& f : s.figures) {
      out.mean_overlap += f.overlap.mean;
      out.lowest_overlap = std::min(out.lowest_overlap, f.overlap.mean);
      out.distance_95_m += f.distance_95_m;
    }
    for (const auto& [frame, why] : s.failures)
      out.warnings.push_back(s.name + ", frame " + std::to_string(frame) + ": the fit " + why + "; it is interpolated");
  }
  if (out.frames) out.mean_overlap /= out.frames, out.distance_95_m /= out.frames;
}

Status writeTrackReport(const std::string& folder, const Prepared& job, const Work& work, const ChosenTemplate& chosen,
                        std::span<const TrackingStep> steps, std::span<const TrackedSequence> sequences,
                        const TrackSummary& summary) {
  Json json{{"template", {{"sequence", summary.template_frame.sequence}, {"frame", summary.template_frame.frame}}},
            {"faces", summary.faces},
            {"vertices", summary.vertices}};
  report::Document page;
  page.title = "Tracking of " + job.capture.name;
  page.credit = job.capture.credit;
  std::vector<Values> rows;
  for (const TrackedSequence& s : sequences) {
    Json frames = Json::array();
    for (const FitFigures& f : s.figures) frames.push_back(jsonOf(f));
    json["sequences"][s.name] = frames;
    for (uint32_t f = 0; f < s.figures.size(); ++f) {
      const FitFigures& figures = s.figures[f];
      rows.push_back({{"", "frame", s.name + " " + std::to_string(f)},
                      {"", "overlap", fixedText(figures.overlap.mean, 4)},
                      {"", "95 %, mm", fixedText(1e3 * figures.distance_95_m, 1)},
                      {"", "maximum, mm", fixedText(1e3 * figures.distance_max_m, 1)},
                      {"", "stretched", std::to_string(figures.stretched_faces)},
                      {"", "colour", fixedText(figures.colour_error, 2)},
                      {"", "seconds", fixedText(s.seconds[f], 1)}});
    }
  }
  report::Section section{"frames", "Frames", "", {}, {}, {}, {}, {}};
  section.tables.push_back(report::tableOf("Fits", "", rows));
  page.sections.push_back(section);
  return report::writeReport(folder, "track", page, json);
}

}  // namespace fourdvt::track
