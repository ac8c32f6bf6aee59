// SPDX-License-Identifier: Apache-2.0
#include "track/run/report.h"

#include <algorithm>

#include "base/text.h"
#include "platform/files.h"
#include "report/document.h"
#include "report/values.h"
#include "track/run/drawing.h"

namespace fourdvt::track {
namespace {

using report::fixedText, report::Json, report::Values;

constexpr size_t kWorst = 4;      // frames that are shown
constexpr float kHot_m = 0.015f;  // distance that is drawn in full red

struct PlacedFrame {
  size_t sequence = 0;
  uint32_t frame = 0;
  double misfit = 0;
};

Json jsonOf(const FitFigures& f) {
  return {{"overlap", f.overlap.mean},
          {"lowest_overlap", f.overlap.lowest},
          {"distance_95_mm", 1e3 * f.distance_95_m},
          {"distance_max_mm", 1e3 * f.distance_max_m},
          {"farthest_m", {f.farthest.x, f.farthest.y, f.farthest.z}},
          {"seen_share", f.seen_share},
          {"stretched_faces", f.stretched_faces},
          {"flipped_faces", f.flipped_faces},
          {"lost_share", f.lost_share},
          {"colour_error", f.colour_error}};
}

double meanOf(const TrackedSequence& s, double (*value)(const FitFigures&)) {
  double sum = 0;
  for (const FitFigures& f : s.figures) sum += value(f);
  return s.figures.empty() ? 0 : sum / double(s.figures.size());
}
double overlapOfFit(const FitFigures& f) { return f.overlap.mean; }
double distanceOfFit(const FitFigures& f) { return 1e3 * f.distance_95_m; }
double colourOfFit(const FitFigures& f) { return f.colour_error; }

// Mean change of velocity of all vertices from frame to frame.
double boilOf(const TrackedSequence& s) {
  double sum = 0;
  size_t count = 0;
  for (size_t f = 1; f + 1 < s.positions.size(); ++f)
    for (size_t v = 0; v < s.positions[f].size(); ++v, ++count)
      sum += glm::length(s.positions[f - 1][v] - 2.f * s.positions[f][v] + s.positions[f + 1][v]);
  return count ? sum / double(count) : 0;
}

report::Plot plotOf(const char* title, const char* label, std::span<const TrackedSequence> sequences,
                    double (*value)(const FitFigures&)) {
  report::Plot plot{.title = title, .x_label = "frame", .y_label = label};
  for (const TrackedSequence& s : sequences) {
    report::Curve curve{s.name, {}};
    for (uint32_t f = 0; f < s.figures.size(); ++f) curve.points.push_back({double(f), value(s.figures[f])});
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

report::Plot depthPlot(const Work& work, std::span<const TrackedSequence> sequences,
                       std::span<const TrackingStep> steps) {
  report::Plot plot{.title = "Depth in the tree of similar frames", .x_label = "frame", .y_label = "steps"};
  std::vector<uint32_t> depths(work.frames().count, 0);
  for (const TrackingStep& step : steps) depths[step.frame] = step.depth;
  for (size_t s = 0; s < sequences.size(); ++s) {
    report::Curve curve{sequences[s].name, {}};
    for (uint32_t f = 0; f < sequences[s].figures.size(); ++f)
      curve.points.push_back({double(f), double(depths[work.frames().starts[s] + f])});
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

Json loopsJson(std::span<const TrackedSequence> sequences) {
  Json out = Json::object();
  for (const TrackedSequence& s : sequences) {
    if (!s.cycle) continue;
    const Cycle& cycle = s.cycle->cycle;
    out[s.name] = {{"first_frame", cycle.first},
                   {"frames", cycle.last - cycle.first},
                   {"misfit_mm", 1e3 * cycle.error_m},
                   {"misfit_share", cycle.error_share},
                   {"travel_mps", glm::length(s.cycle->travel.velocity_mps)}};
  }
  return out;
}

Values sequenceValues(const TrackedSequence& s) {
  double seconds = 0;
  for (const double t : s.seconds) seconds += t;
  return {{"name", "sequence", s.name},
          {"frames", "frames", s.figures.size()},
          {"overlap", "overlap with mattes", meanOf(s, overlapOfFit), 4},
          {"distance_95_mm", "95 % off the surface, mm", meanOf(s, distanceOfFit), 1},
          {"colour_error", "colour, levels", meanOf(s, colourOfFit), 1},
          {"acceleration_mm", "change of velocity, mm a frame", 1e3 * boilOf(s), 2},
          {"interpolated", "interpolated", s.failures.size()},
          {"seconds", "s a frame", seconds / double(std::max<size_t>(1, s.figures.size())), 1}};
}

std::vector<PlacedFrame> worstOf(std::span<const TrackedSequence> sequences) {
  std::vector<PlacedFrame> out;
  for (size_t s = 0; s < sequences.size(); ++s)
    for (uint32_t f = 0; f < sequences[s].figures.size(); ++f) out.push_back({s, f, misfit(sequences[s].figures[f])});
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.misfit > b.misfit; });
  out.resize(std::min(out.size(), kWorst));
  return out;
}

// [vertex] mean distance from the surfaces where it is seen, for the heat map; negative: never seen.
std::vector<float> meanDistances(std::span<const TrackedSequence> sequences, size_t vertices) {
  std::vector<float> sums(vertices, 0), counts(vertices, 0);
  for (const TrackedSequence& s : sequences)
    for (const FitFigures& f : s.figures)
      for (size_t v = 0; v < std::min(vertices, f.vertex_distance_m.size()); ++v)
        if (f.vertex_distance_m[v] >= 0) sums[v] += f.vertex_distance_m[v], counts[v] += 1;
  for (size_t v = 0; v < vertices; ++v) sums[v] = counts[v] > 0 ? sums[v] / counts[v] / kHot_m : -1;
  return sums;
}

class Pictures {
 public:
  Pictures(const std::string& folder, const Work& work, const ChosenTemplate& chosen)
      : folder_(folder), work_(work), faces_(chosen.mesh.topology.face_vertices) {}

  Status add(uint32_t frame, const std::string& caption, const Positions& positions, std::span<const float> heat,
             report::Section& section) {
    FOURDVT_ASSIGN(const FramePictures pictures, work_.pictures(frame));
    const Image sheet = trackedSheet(work_.nameOf(frame), pictures.views, faces_, positions, heat);
    const std::string file = "track-" + std::to_string(++count_) + ".jpg";
    section.pictures.push_back({file, caption, sheet.width, sheet.height});
    return platform::writeImage(folder_ + "/" + file, sheet);
  }

 private:
  const std::string& folder_;
  const Work& work_;
  const std::vector<glm::uvec3>& faces_;
  int count_ = 0;
};

}  // namespace

void summarise(std::span<const TrackedSequence> sequences, TrackSummary& out) {
  for (const TrackedSequence& s : sequences) {
    if (s.cycle)
      out.loops.push_back(
          printed("%s: frames %u to %u are a loop, whose ends differ by %.1f mm; it travels at %.2f m/s",
                  s.name.c_str(), s.cycle->cycle.first, s.cycle->cycle.last - 1, 1e3 * s.cycle->cycle.error_m,
                  glm::length(s.cycle->travel.velocity_mps)));
    out.frames += uint32_t(s.figures.size());
    out.interpolated += uint32_t(s.failures.size());
    for (const FitFigures& f : s.figures) {
      out.mean_overlap += f.overlap.mean;
      out.lowest_overlap = std::min(out.lowest_overlap, f.overlap.mean);
      out.distance_95_m += f.distance_95_m;
    }
    for (const auto& [frame, why] : s.failures)
      out.warnings.push_back(s.name + ", frame " + std::to_string(frame) + ": the mesh " + why +
                             "; it is interpolated from its neighbours");
  }
  if (out.frames) out.mean_overlap /= out.frames, out.distance_95_m /= out.frames;
}

Status writeTrackReport(const std::string& folder, const Prepared& job, const Work& work, const ChosenTemplate& chosen,
                        std::span<const TrackingStep> steps, std::span<const TrackedSequence> sequences,
                        const TrackSummary& summary) {
  const FrameName& origin = summary.template_frame;
  const Values values{
      {"generator", "fourdvt track"},
      {"template/sequence", origin.sequence},
      {"template/frame", origin.frame},
      {"faces", "triangles", summary.faces},
      {"vertices", summary.vertices},
      {"frames", "frames", summary.frames},
      {"mean_overlap", "mean overlap of mesh and mattes", summary.mean_overlap, 4},
      {"lowest_overlap", "lowest overlap of a frame", summary.lowest_overlap, 4},
      {"distance_95_mm", "mm: 95 % of the mesh lies nearer to the surfaces", 1e3 * summary.distance_95_m, 1},
      {"interpolated", "frames interpolated", summary.interpolated},
      {"loops", loopsJson(sequences)},
      {"warnings", summary.warnings}};
  report::Document page{
      job.capture.name + ", tracked",
      std::to_string(summary.faces) + " triangles from " + origin.sequence + ", frame " + std::to_string(origin.frame)};
  page.credit = job.capture.credit;
  report::Section overview{.id = "overview", .title = "Overview"};
  for (const auto* lines : {&summary.warnings, &summary.loops})
    for (const std::string& line : *lines) overview.text += line + ".\n\n";
  overview.tiles = report::tilesOf(values);
  overview.tables = {report::tableOf("Sequences",
                                     "Colour: mean difference of vertices' grey from the template's frame.",
                                     report::rowsOf(sequences, sequenceValues))};
  overview.plots = {plotOf("Overlap with the mattes", "intersection over union", sequences, overlapOfFit),
                    plotOf("Distance from the surfaces", "95 %, mm", sequences, distanceOfFit),
                    plotOf("Colour against the template's frame", "levels", sequences, colourOfFit),
                    depthPlot(work, sequences, steps)};

  Pictures pictures(folder, work, chosen);
  report::Section mesh{.id = "template", .title = "The template"};
  mesh.text =
      "Below each picture the mesh; green is the outline of the matte. Red: far from the surfaces on the average "
      "of all frames, 15 mm and more. Blue: never seen.";
  FOURDVT_TRY(pictures.add(chosen.frame, origin.sequence + ", frame " + std::to_string(origin.frame),
                           chosen.mesh.positions, meanDistances(sequences, summary.vertices), mesh));
  report::Section worst{.id = "worst", .title = "The worst frames"};
  worst.text = "Frames whose mesh agrees least with mattes, surface and colours, and that distance in the frame.";
  for (const PlacedFrame& at : worstOf(sequences)) {
    const FitFigures& f = sequences[at.sequence].figures[at.frame];
    std::vector<float> heat = f.vertex_distance_m;
    for (float& h : heat) h = h < 0 ? -1 : h / kHot_m;
    const std::string caption =
        printed("%s, frame %u: overlap %.3f, 95 %% within %.1f mm, farthest %.0f mm at (%.2f, %.2f, %.2f) m",
                sequences[at.sequence].name.c_str(), at.frame, f.overlap.mean, 1e3 * f.distance_95_m,
                1e3 * f.distance_max_m, f.farthest.x, f.farthest.y, f.farthest.z);
    FOURDVT_TRY(pictures.add(work.frames().starts[at.sequence] + at.frame, caption,
                             sequences[at.sequence].positions[at.frame], heat, worst));
  }
  page.sections = {std::move(overview), std::move(mesh), std::move(worst)};

  Json json = report::jsonOf(values);
  for (const TrackedSequence& s : sequences)
    for (const FitFigures& f : s.figures) json["sequences"][s.name].push_back(jsonOf(f));
  return report::writeReport(folder, "track", page, json);
}

}  // namespace fourdvt::track
