// SPDX-License-Identifier: Apache-2.0
#include "bake/report/report.h"

#include <sys/resource.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bake/report/method_report.h"
#include "bake/run/stage_table.h"
#include "report/document.h"
#include "report/text.h"

namespace fourdvt::bake {
namespace {

using Json = nlohmann::ordered_json;
using report::bytesText, report::fixedText, report::percentText, report::secondsText;
using StageSeconds = std::vector<std::pair<std::string, double>>;

const char* penaltyName(Penalty penalty) {
  constexpr const char* kNames[] = {"axis", "ray", "resolution"};
  return kNames[static_cast<int>(penalty)];
}

const char* filterName(ResampleFilter filter) {
  constexpr const char* kNames[] = {"bilinear", "mipmap", "bicubic"};
  return kNames[static_cast<int>(filter)];
}

StageSeconds orderedStages(const ReportInput& in) {
  StageSeconds out;
  for (const StageInfo& stage : kStages)
    if (const auto it = in.figures.seconds_by_stage.find(stage.name); it != in.figures.seconds_by_stage.end())
      out.emplace_back(*it);
  return out;
}

uint64_t streamedBytes(const ReportSequence& s) {
  return s.video_bytes + s.geometry_bytes + s.label_bytes + s.offset_bytes + s.alignment_bytes + s.index_bytes;
}

double megabitsPerSecond(const ReportSequence& s, uint64_t bytes) {
  return s.frames ? bytes * 8e-6 * s.fps / s.frames : 0;
}

uint64_t totalBytes(const ReportInput& in) {
  uint64_t sum = 0;
  for (const auto& [part, bytes] : in.figures.bytes_by_part) sum += bytes;
  return sum;
}

bool fromCameras(const ReportInput& in) { return in.options.appearance == package::AppearanceKind::Cameras; }

Json renditionsJson(const BakeOptions& o) {
  Json json = Json::array();
  for (const LowerRendition& r : o.lower_renditions)
    json.push_back({{"size", r.size}, {"crf", r.crf}, {"codec", infoOf(r.codec).name}, {"preset", r.preset}});
  return json;
}

Json cameraOptionsJson(const BakeOptions& o) {
  return {{"sequences", o.sequences},
          {"appearance", "cameras"},
          {"tile_scale", o.cameras.tile_scale},
          {"max_texels", o.cameras.max_texels},
          {"faces", o.cameras.faces},
          {"method", o.cameras.method.empty() ? "auto" : o.cameras.method},
          {"method_cost", o.cameras.choice.most_cost},
          {"crf", o.crf},
          {"gop", o.gop},
          {"jobs", o.jobs},
          {"position_step_m", *o.position_step_m},
          {"refine", o.refine.outline ? "outline" : "none"},
          {"refine_cameras", o.refine.cameras},
          {"colour_calibration", o.colour_calibration},
          {"preset", o.preset},
          {"lower_renditions", renditionsJson(o)}};
}

Json optionsJson(const BakeOptions& o) {
  if (o.appearance == package::AppearanceKind::Cameras) return cameraOptionsJson(o);
  return {{"sequences", o.sequences},
          {"layers", o.layers},
          {"texture", o.texture},
          {"crf", o.crf},
          {"gop", o.gop},
          {"jobs", o.jobs},
          {"position_step_m", *o.position_step_m},
          {"gutter_texels", o.gutter_texels},
          {"refine", o.refine.outline ? "outline" : "none"},
          {"refine_cameras", o.refine.cameras},
          {"labels", o.labels->name},
          {"penalty", penaltyName(o.penalty)},
          {"filter", filterName(o.resample.filter)},
          {"equal_layers", o.equal_layers},
          {"colour_calibration", o.colour_calibration},
          {"classes", o.classes.bake},
          {"align", o.classes.align ? "baked" : "none"},
          {"blend_error_mm", *o.classes.blend_error_m * 1e3},
          {"alignment_step_m", *o.classes.alignment_step_m},
          {"preset", o.preset},
          {"lower_renditions", renditionsJson(o)}};
}

Json sequenceJson(const ReportSequence& s) {
  Json json = {{"name", s.name},
               {"frames", s.frames},
               {"gops", s.gops},
               {"fps", s.fps},
               {"loop", s.loop},
               {"members", s.members},
               {"video_bytes", s.video_bytes},
               {"geometry_bytes", s.geometry_bytes},
               {"label_bytes", s.label_bytes},
               {"offset_bytes", s.offset_bytes},
               {"alignment_bytes", s.alignment_bytes},
               {"index_bytes", s.index_bytes},
               {"video_mbit_per_s", megabitsPerSecond(s, s.video_bytes)},
               {"total_mbit_per_s", megabitsPerSecond(s, streamedBytes(s))}};
  json["renditions"] = Json::array();
  for (const ReportRendition& r : s.renditions)
    json["renditions"].push_back({{"file", r.file},
                                  {"codec", r.codec},
                                  {"width", r.width},
                                  {"height", r.height},
                                  {"bytes", r.bytes},
                                  {"mbit_per_s", megabitsPerSecond(s, r.bytes)},
                                  {"total_mbit_per_s", megabitsPerSecond(s, r.bytes + r.geometry_bytes)}});
  if (!s.tiles) return json;
  json["geometry_mbit_per_s"] = megabitsPerSecond(s, s.geometry_bytes);
  json["tiles"] = {{"width", s.tiles->width},
                   {"height", s.tiles->height},
                   {"kept_share", s.tiles->kept_share},
                   {"used_share", s.tiles->used_share},
                   {"runs", s.tiles->runs},
                   {"vertices", s.tiles->vertices},
                   {"faces", s.tiles->faces}};
  return json;
}

Json classJson(const ClassSummary& c) {
  Json json = {{"members", c.members},
               {"references", c.references},
               {"linear_error_mm", c.linear_error_m * 1e3},
               {"hybrid_error_mm", c.hybrid_error_m * 1e3},
               {"aligned", c.aligned}};
  json["parameters"] = Json::array();
  for (const auto& p : c.parameters) json["parameters"].push_back({{"name", p.name}, {"min", p.min}, {"max", p.max}});
  return json;
}

report::BarChart stageChart(const ReportInput& in) {
  report::BarChart chart;
  const double frames = std::max(1u, in.figures.frames);
  for (const auto& [stage, s] : orderedStages(in)) chart.bars.push_back({stage, secondsText(s / frames), s / frames});
  return chart;
}

report::BarChart sizeChart(const ReportInput& in) {
  report::BarChart chart;
  const double total = std::max<double>(1, static_cast<double>(totalBytes(in)));
  for (const auto& [part, bytes] : in.figures.bytes_by_part)
    chart.bars.push_back({part, bytesText(bytes) + " · " + percentText(100 * bytes / total), double(bytes)});
  std::sort(chart.bars.begin(), chart.bars.end(),
            [](const report::Bar& a, const report::Bar& b) { return a.value > b.value; });
  return chart;
}

std::vector<report::Tile> tilesOf(const ReportInput& in) {
  const double frames = std::max(1u, in.figures.frames);
  double peak_rate = 0;
  for (const ReportSequence& s : in.sequences) peak_rate = std::max(peak_rate, megabitsPerSecond(s, streamedBytes(s)));
  const size_t sequences = in.sequences.size();
  std::vector<report::Tile> tiles{
      {bytesText(totalBytes(in)), "whole character"},
      {fixedText(peak_rate, 2) + " Mbit/s", "busiest sequence, all streams"},
      {std::to_string(in.figures.frames),
       sequences == 1 ? "frames in 1 sequence" : "frames in " + std::to_string(sequences) + " sequences"},
      {secondsText(in.wall_s / frames), in.resumed ? "per frame, of a resumed run" : "per frame, whole bake"}};
  if (in.figures.peak_rss_bytes) tiles.push_back({bytesText(in.figures.peak_rss_bytes), "peak memory"});
  return tiles;
}

std::string playedSeconds(const ReportSequence& s) { return fixedText(s.fps > 0 ? s.frames / s.fps : 0, 2); }

report::Table cameraSequenceTable(const ReportInput& in) {
  report::Table table{
      "",
      "Kept: the share of the cameras' whole pictures that is in the tiled picture. Used: the share of the "
      "tiled picture that shows them. Runs: frames of one topology that follow each other.",
      {"sequence", "frames", "seconds", "GOPs", "layout", "kept", "used", "runs", "most faces", "pictures", "surfaces",
       "index", "pictures, Mbit/s", "surfaces, Mbit/s", "Mbit/s"},
      {}};
  for (const ReportSequence& s : in.sequences) {
    const ReportTiles tiles = s.tiles.value_or(ReportTiles{});
    table.rows.push_back(
        {s.name + (s.loop ? " ↻" : ""), std::to_string(s.frames), playedSeconds(s), std::to_string(s.gops),
         std::to_string(tiles.width) + " × " + std::to_string(tiles.height), percentText(100 * tiles.kept_share),
         percentText(100 * tiles.used_share), std::to_string(tiles.runs), std::to_string(tiles.faces),
         bytesText(s.video_bytes), bytesText(s.geometry_bytes), bytesText(s.index_bytes),
         fixedText(megabitsPerSecond(s, s.video_bytes), 2), fixedText(megabitsPerSecond(s, s.geometry_bytes), 2),
         fixedText(megabitsPerSecond(s, streamedBytes(s)), 2)});
  }
  return table;
}

report::Table sequenceTable(const ReportInput& in) {
  if (fromCameras(in)) return cameraSequenceTable(in);
  report::Table table{"",
                      "",
                      {"sequence", "frames", "seconds", "GOPs", "video", "geometry", "labels", "corrections",
                       "alignment", "index", "Mbit/s"},
                      {}};
  const auto ofClass = [](const ReportSequence& s, uint64_t bytes) { return s.members > 1 ? bytesText(bytes) : "–"; };
  for (const ReportSequence& s : in.sequences)
    table.rows.push_back({s.name + (s.loop ? " ↻" : ""), std::to_string(s.frames), playedSeconds(s),
                          std::to_string(s.gops), bytesText(s.video_bytes), bytesText(s.geometry_bytes),
                          bytesText(s.label_bytes), ofClass(s, s.offset_bytes), ofClass(s, s.alignment_bytes),
                          bytesText(s.index_bytes), fixedText(megabitsPerSecond(s, streamedBytes(s)), 2)});
  return table;
}

report::Table renditionTable(const ReportInput& in) {
  report::Table table{"",
                      "The same frames and labels with pictures of other bitrates, and shapes that are coarser where "
                      "the picture is smaller, the lowest first; the tables above are of the highest, which poster, "
                      "alignment and scores use.",
                      {"sequence", "video", "picture", "codec", "bytes", "Mbit/s", "with geometry"},
                      {}};
  for (const ReportSequence& s : in.sequences)
    for (const ReportRendition& r : s.renditions)
      table.rows.push_back({&r == s.renditions.data() ? s.name : "", r.file,
                            std::to_string(r.width) + " × " + std::to_string(r.height), r.codec, bytesText(r.bytes),
                            fixedText(megabitsPerSecond(s, r.bytes), 2),
                            fixedText(megabitsPerSecond(s, r.bytes + r.geometry_bytes), 2)});
  return table;
}

std::string rangeText(const ClassSummary& c) {
  std::string text;
  for (const auto& p : c.parameters)
    text += (text.empty() ? "" : ", ") + p.name + " " + fixedText(p.min, 2) + "…" + fixedText(p.max, 2);
  return text;
}

report::Table classTable(const ReportInput& in) {
  report::Table table{
      "",
      "",
      {"class", "members", "parameter", "phases", "seconds", "references", "linear error", "hybrid error", "alignment"},
      {}};
  for (const ReportSequence& s : in.sequences) {
    const auto found = in.figures.classes.find(s.name);
    if (found == in.figures.classes.end()) continue;
    const ClassSummary& c = found->second;
    std::string members;
    for (const std::string& name : c.members) members += (members.empty() ? "" : ", ") + name;
    table.rows.push_back({s.name, members, rangeText(c), std::to_string(s.frames), playedSeconds(s),
                          std::to_string(c.references), fixedText(c.linear_error_m * 1e3, 2) + " mm",
                          fixedText(c.hybrid_error_m * 1e3, 2) + " mm", c.aligned ? "baked" : "none"});
  }
  return table;
}

report::Table labelTable(const ReportInput& in) {
  report::Table table{"",
                      "",
                      {"sequence", "layer", "seam edges", "flips per frame", "seam edges, seen faces",
                       "flips per frame, seen faces", "mean penalty"},
                      {}};
  for (const auto& [name, s] : in.figures.labels_by_sequence)
    for (size_t l = 0; l < s.seam_percent.size(); ++l)
      table.rows.push_back({l == 0 ? name : "", std::to_string(l + 1), percentText(s.seam_percent[l]),
                            percentText(s.flip_percent[l]), percentText(s.seen_seam_percent[l]),
                            percentText(s.seen_flip_percent[l]), fixedText(s.mean_penalty[l], 3)});
  return table;
}

report::Table cameraFactsTable(const ReportInput& in) {
  const BakeOptions& o = in.options;
  report::Table table{
      "",
      "",
      {"", "value"},
      {{"cameras", std::to_string(in.cameras)},
       {"surfaces", "up to " + std::to_string(in.faces) + " faces, " + std::to_string(in.vertices) + " vertices"},
       {"tile scale", fixedText(o.cameras.tile_scale, 2) + " texels per pixel"},
       {"colour calibration", o.colour_calibration ? "on" : "off"},
       {"codec", in.codec + ", CRF " + std::to_string(o.crf) + ", GOP ≤ " + std::to_string(o.gop) + " frames"},
       {"vertex step", fixedText(*o.position_step_m * 1e3, 3) + " mm"},
       {"jobs", std::to_string(o.jobs)}}};
  for (const auto& [library, version] : in.versions) table.rows.push_back({library, version});
  return table;
}

report::Table factsTable(const ReportInput& in) {
  if (fromCameras(in)) return cameraFactsTable(in);
  const BakeOptions& o = in.options;
  report::Table table{
      "",
      "",
      {"", "value"},
      {{"cameras", std::to_string(in.cameras)},
       {"mesh", std::to_string(in.faces) + " faces, " + std::to_string(in.vertices) + " vertices"},
       {"tiled picture", std::to_string(in.picture_width) + " × " + std::to_string(in.picture_height) + " texels"},
       {"layers", std::to_string(o.layers)},
       {"texture",
        std::to_string(o.texture) + (o.equal_layers ? " texels, all layers" : " texels, further layers half of it")},
       {"mesh and cameras",
        std::string(o.refine.outline ? "mesh moved to the mattes' outlines" : "mesh as given") +
            (o.refine.cameras ? ", cameras corrected where the mattes contradict them" : ", cameras as given")},
       {"labels", o.labels->name},
       {"penalty", penaltyName(o.penalty)},
       {"resampling filter", filterName(o.resample.filter)},
       {"colour calibration", o.colour_calibration ? "on" : "off"},
       {"codec", in.codec + ", CRF " + std::to_string(o.crf) + ", GOP ≤ " + std::to_string(o.gop) + " frames"},
       {"vertex step", fixedText(*o.position_step_m * 1e3, 3) + " mm"},
       {"gutter", std::to_string(o.gutter_texels) + " texels"},
       {"jobs", std::to_string(o.jobs)}}};
  for (const auto& [library, version] : in.versions) table.rows.push_back({library, version});
  return table;
}

report::Section section(const char* id, const char* title, std::string text, std::vector<report::Table> tables) {
  return {id, title, std::move(text), std::move(tables), {}, {}, {}, {}};
}

std::string residualText(const refine::Residuals& r) {
  return fixedText(r.median_pixels, 2) + " / " + fixedText(r.p95_pixels, 2);
}

report::Table refinedCamerasTable(const refine::Refinement& r) {
  report::Table table{"",
                      "px: pixels of the camera's picture. Median and 95 % of the distances' sizes. Bias: how far the "
                      "matte's edge lies outside the edge in the picture; corrected if it is 0.25 px or more.",
                      {"camera", "points", "bias, px", "before, px", "after, px", "fits best, px", "turned, °",
                       "moved, mm", "zoomed, %"},
                      {}};
  for (const refine::CameraRefinement& c : r.by_camera) {
    std::string bias = c.measured_bias_pixels ? fixedText(*c.measured_bias_pixels, 2) : "no contrast";
    if (c.used_bias_pixels != 0) bias += ", corrected by " + fixedText(c.used_bias_pixels, 2);
    const auto changed = [&](double value, int digits) { return c.changed ? fixedText(value, digits) : "–"; };
    table.rows.push_back({c.name, std::to_string(c.before.points), bias, residualText(c.before), residualText(c.after),
                          c.best ? fixedText(c.best->pixels, 2) + " ± " + fixedText(c.best->deviation_pixels, 2) : "–",
                          changed(glm::length(c.turn_deg), 3), changed(c.move_m * 1e3, 1), changed(c.zoom_percent, 3)});
  }
  return table;
}

report::Plot residualPlot(const refine::Refinement& r) {
  report::Plot plot;
  plot.title = "Distances between outlines";
  plot.x_label = "pixels; left: the mesh is too large";
  plot.y_label = "% of the points";
  for (const auto& [name, histogram] : {std::pair{"as given", &r.before}, {"refined", &r.after}}) {
    report::Curve curve{name, {}};
    for (size_t i = 0; i < histogram->size(); ++i)
      curve.points.push_back({(double(i) + 0.5) * refine::kBinPixels - refine::kReachPixels, 100 * (*histogram)[i]});
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

std::string refinementText(const ReportInput& in, const refine::Refinement& r) {
  std::string text = "The outlines of the mesh against those of the mattes, in " + std::to_string(r.frames) +
                     " frames of every camera. ";
  if (r.offsets)
    text += "Every vertex moved along its normal by an offset of its own: half of them by " +
            fixedText(r.offset_median_m * 1e3, 2) + " mm or less, 5 % by less than " +
            fixedText(r.offset_low_m * 1e3, 2) + " mm, 5 % by more than " + fixedText(r.offset_high_m * 1e3, 2) +
            " mm (negative: inwards).";
  if (!r.note.empty()) text += "\n\n" + r.note;
  if (r.offsets && r.slow.empty()) text += " The offsets are the same in all frames.";
  for (size_t i = 0; i < r.slow.size(); ++i)
    text += (i == 0 ? " They also vary slowly with time in " : ", ") + r.slow[i] + (i + 1 == r.slow.size() ? "." : "");
  if (!in.refined_cameras.empty())
    text += "\n\nThe changed cameras are in `" + in.refined_cameras +
            "` as a COLMAP text model in the capture's unit. Copy it over the capture's own to keep it.";
  return text;
}

report::Section refinementSection(const ReportInput& in) {
  const refine::Refinement& r = *in.figures.refinement;
  report::Section out =
      section("refinement", "Mesh and cameras against the pictures", refinementText(in, r), {refinedCamerasTable(r)});
  out.plots = {residualPlot(r)};
  for (const ReportPicture& p : in.outlines) out.pictures.push_back({p.file, p.caption});
  return out;
}

Json residualJson(const refine::Residuals& r) {
  return {{"points", r.points},
          {"bias_pixels", r.bias_pixels},
          {"median_pixels", r.median_pixels},
          {"p95_pixels", r.p95_pixels}};
}

Json refinementJson(const refine::Refinement& r) {
  Json json;
  json["outline"] = r.options.outline;
  json["cameras"] = r.options.cameras;
  json["frames"] = r.frames;
  json["rounds"] = r.rounds;
  json["moved"] = bool(r.offsets);
  json["offset_mm"] = {
      {"p5", r.offset_low_m * 1e3}, {"median", r.offset_median_m * 1e3}, {"p95", r.offset_high_m * 1e3}};
  json["varying_sequences"] = r.slow;
  json["note"] = r.note;
  json["by_camera"] = Json::array();
  for (const refine::CameraRefinement& c : r.by_camera) {
    Json camera{{"name", c.name},
                {"before", residualJson(c.before)},
                {"after", residualJson(c.after)},
                {"matte_bias_pixels", c.used_bias_pixels},
                {"changed", c.changed},
                {"turn_deg", {c.turn_deg.x, c.turn_deg.y, c.turn_deg.z}},
                {"turn_deviation_deg", {c.turn_deviation_deg.x, c.turn_deviation_deg.y, c.turn_deviation_deg.z}},
                {"move_mm", c.move_m * 1e3},
                {"zoom_percent", c.zoom_percent}};
    if (c.best) {
      camera["shift_pixels"] = c.best->pixels;
      camera["shift_deviation_pixels"] = c.best->deviation_pixels;
    }
    if (c.measured_bias_pixels) camera["measured_matte_bias_pixels"] = *c.measured_bias_pixels;
    json["by_camera"].push_back(std::move(camera));
  }
  return json;
}

std::string notesText(const ReportInput& in) {
  std::string text;
  for (const std::string& note : in.figures.notes) text += note + "\n\n";
  return text;
}

}  // namespace

std::string reportJson(const ReportInput& in) {
  Json root;
  root["generator"] = in.generator;
  root["capture"] = {{"name", in.capture_name}, {"credit", in.credit}};
  root["options"] = optionsJson(in.options);
  root["codec"] = in.codec;
  root["cameras"] = in.cameras;
  root["vertices"] = in.vertices;
  root["faces"] = in.faces;
  root["picture"] = {{"width", in.picture_width}, {"height", in.picture_height}};
  root["frames"] = in.figures.frames;
  root["resumed"] = in.resumed;
  root["wall_s"] = in.wall_s;
  root["wall_s_per_frame"] = in.figures.frames ? in.wall_s / in.figures.frames : 0.0;
  root["peak_rss_bytes"] = in.figures.peak_rss_bytes;
  Json stages = Json::object(), stages_frame = Json::object();
  for (const auto& [stage, s] : orderedStages(in)) {
    stages[stage] = s;
    stages_frame[stage] = in.figures.frames ? s / in.figures.frames : 0.0;
  }
  root["seconds_by_stage"] = std::move(stages);
  root["seconds_per_frame_by_stage"] = std::move(stages_frame);
  root["bytes_by_part"] = in.figures.bytes_by_part;
  root["bytes"] = totalBytes(in);
  root["labels"] = Json::object();
  for (const auto& [name, l] : in.figures.labels_by_sequence)
    root["labels"][name] = {{"seam_percent", l.seam_percent},
                            {"flip_percent", l.flip_percent},
                            {"seen_seam_percent", l.seen_seam_percent},
                            {"seen_flip_percent", l.seen_flip_percent},
                            {"mean_penalty", l.mean_penalty},
                            {"energy", l.energy},
                            {"seconds", l.seconds}};
  root["classes"] = Json::object();
  for (const auto& [name, c] : in.figures.classes) root["classes"][name] = classJson(c);
  if (in.figures.refinement) root["refinement"] = refinementJson(*in.figures.refinement);
  if (in.figures.method) root["method"] = methodJson(*in.figures.method);
  root["notes"] = in.figures.notes;
  root["sequences"] = Json::array();
  for (const ReportSequence& s : in.sequences) root["sequences"].push_back(sequenceJson(s));
  root["versions"] = Json::object();
  for (const auto& [library, version] : in.versions) root["versions"][library] = version;
  root["pictures"] = Json::array();
  for (const ReportPicture& p : in.pictures) root["pictures"].push_back({{"file", p.file}, {"caption", p.caption}});
  return root.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string reportHtml(const ReportInput& in) {
  report::Document page;
  page.title = in.capture_name;
  page.subtitle = "Baked by " + in.generator + " from " + std::to_string(in.cameras) + " cameras into " +
                  (fromCameras(in) ? "one tiled picture of the performer."
                                   : std::to_string(in.options.layers) + " view-dependent texture layers.");
  page.credit = in.credit;
  report::Section summary = section("summary", "Summary", "", {});
  summary.tiles = tilesOf(in);
  report::Section stages = section("stages", "Seconds per frame, by stage", "", {});
  if (in.resumed) stages.text = "This run continued an interrupted one; times are of the GOPs that it baked.\n\n";
  stages.text += "Stages overlap on " + std::to_string(in.options.jobs) +
                 " jobs, so that their sum may exceed the time of the whole bake.";
  stages.bar_charts = {stageChart(in)};
  report::Section sizes = section("sizes", "What the bytes are", "", {});
  sizes.bar_charts = {sizeChart(in)};
  page.sections = {summary, stages, sizes, section("sequences", "Sequences", notesText(in), {sequenceTable(in)})};
  if (!in.options.lower_renditions.empty())
    page.sections.push_back(section("renditions", "Renditions", "", {renditionTable(in)}));
  if (!in.figures.classes.empty())
    page.sections.push_back(
        section("classes", "Motion classes",
                "Members of a class share one video and common time. Meshes are blended linearly, and corrected at the "
                "references towards the non-linear blend; errors are largest vertex distances to it.",
                {classTable(in)}));
  if (in.figures.refinement) page.sections.push_back(refinementSection(in));
  if (in.figures.method) page.sections.push_back(methodSection(*in.figures.method));
  if (!in.figures.labels_by_sequence.empty())
    page.sections.push_back(section("labels", "Labels", "", {labelTable(in)}));
  if (in.pictures.size() > 1) page.sections.push_back(section("pictures", "Pictures", "", {}));
  for (size_t i = 0; i < in.pictures.size(); ++i) {
    const report::Picture picture{in.pictures[i].file, in.pictures[i].caption};
    if (i == 0)
      page.poster = picture;
    else
      page.sections.back().pictures.push_back(picture);
  }
  page.sections.push_back(section("settings", "Settings", "", {factsTable(in)}));
  return report::documentHtml(page);
}

uint64_t peakResidentBytes() {
  struct rusage usage {};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
#ifdef __APPLE__
  return static_cast<uint64_t>(usage.ru_maxrss);
#else
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
#endif
}

}  // namespace fourdvt::bake
