// SPDX-License-Identifier: Apache-2.0
#include "bake/report/report.h"

#include <algorithm>

#include "bake/run/stage_table.h"
#include "base/text.h"
#include "report/document.h"
#include "report/values.h"

namespace fourdvt::bake {
namespace {

using report::bytesText, report::fixedText, report::percentText, report::secondsText;
using report::Document, report::Json, report::Section, report::Value, report::Values;

std::string count(uint64_t n) { return std::to_string(n); }
std::string textureSize(int width, int height) { return count(width) + " × " + count(height); }
Value bytesValue(const char* key, const char* title, uint64_t bytes) { return {key, title, bytes, bytesText(bytes)}; }

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

void addSummary(const ReportInput& in, Document& page, Json& json) {
  const BakeReport& figures = in.figures;
  const double per_frame = in.wall_s / std::max(1u, figures.frames);
  double peak_rate = 0;
  for (const ReportSequence& s : in.sequences) peak_rate = std::max(peak_rate, megabitsPerSecond(s, streamedBytes(s)));
  const std::string sequences = in.sequences.size() == 1 ? "1 sequence" : count(in.sequences.size()) + " sequences";
  const Values values{
      bytesValue("bytes", "whole character", totalBytes(in)),
      {"", "busiest sequence, all streams", fixedText(peak_rate, 2) + " Mbit/s"},
      {"frames", "frames in " + sequences, figures.frames},
      {"resumed", in.resumed},
      {"wall_s", in.wall_s},
      {"wall_s_per_frame", in.resumed ? "per frame, of a resumed run" : "per frame, whole bake",
       figures.frames ? per_frame : 0, secondsText(per_frame)},
      bytesValue("peak_rss_bytes", figures.peak_rss_bytes ? "peak memory" : "", figures.peak_rss_bytes)};
  json.update(report::jsonOf(values));
  page.sections.push_back({.id = "summary", .title = "Summary", .tiles = report::tilesOf(values)});
}

void addStages(const ReportInput& in, Document& page, Json& json) {
  Section section{.id = "stages", .title = "Seconds per frame, by stage"};
  if (in.resumed) section.text = "This run continued an interrupted one; times are of the GOPs that it baked.\n\n";
  section.text +=
      "Stages overlap on " + count(in.options.jobs) + " jobs, so that their sum may exceed the time of the whole bake.";
  report::BarChart chart;
  for (const StageInfo& stage : kStages) {
    const auto found = in.figures.seconds_by_stage.find(stage.name);
    if (found == in.figures.seconds_by_stage.end()) continue;
    const double per_frame = found->second / std::max(1u, in.figures.frames);
    json["seconds_by_stage"][stage.name] = found->second;
    json["seconds_per_frame_by_stage"][stage.name] = in.figures.frames ? per_frame : 0;
    chart.bars.push_back({stage.name, secondsText(per_frame), per_frame});
  }
  section.bar_charts = {std::move(chart)};
  page.sections.push_back(std::move(section));
}

void addSizes(const ReportInput& in, Document& page, Json& json) {
  json["bytes_by_part"] = in.figures.bytes_by_part;
  report::BarChart chart;
  const double total = std::max<double>(1, static_cast<double>(totalBytes(in)));
  for (const auto& [part, bytes] : in.figures.bytes_by_part)
    chart.bars.push_back({part, bytesText(bytes) + " · " + percentText(100 * bytes / total), double(bytes)});
  std::sort(chart.bars.begin(), chart.bars.end(),
            [](const report::Bar& a, const report::Bar& b) { return a.value > b.value; });
  page.sections.push_back({.id = "sizes", .title = "What the bytes are", .bar_charts = {std::move(chart)}});
}

Value playedSeconds(const ReportSequence& s) { return {"", "seconds", fixedText(s.fps > 0 ? s.frames / s.fps : 0, 2)}; }

std::vector<Values> renditionRows(const ReportSequence& s) {
  return report::rowsOf(s.renditions, [&](const ReportRendition& r) {
    return Values{{"", "sequence", &r == s.renditions.data() ? s.name : ""},
                  {"file", "video", r.file},
                  {"width", r.width},
                  {"height", "picture", r.height, textureSize(r.width, r.height)},
                  {"codec", "codec", r.codec},
                  bytesValue("bytes", "bytes", r.bytes),
                  {"mbit_per_s", "Mbit/s", megabitsPerSecond(s, r.bytes), 2},
                  {"total_mbit_per_s", "with geometry", megabitsPerSecond(s, r.bytes + r.geometry_bytes), 2}};
  });
}

Values sequenceValues(const ReportSequence& s) {
  const auto of_class = [&](uint64_t bytes) { return s.members > 1 ? bytesText(bytes) : "–"; };
  Values out{{"name", "sequence", s.name, s.name + (s.loop ? " ↻" : "")},
             {"frames", "frames", s.frames},
             playedSeconds(s),
             {"gops", "GOPs", s.gops},
             {"fps", s.fps},
             {"loop", s.loop},
             {"members", s.members},
             {"renditions", report::jsonOf(renditionRows(s))}};
  if (const auto& tiles = s.tiles)
    append(out, {{"tiles/width", tiles->width},
                 {"tiles/height", "layout", tiles->height, textureSize(tiles->width, tiles->height)},
                 {"tiles/kept_share", "kept", tiles->kept_share, percentText(100 * tiles->kept_share)},
                 {"tiles/used_share", "used", tiles->used_share, percentText(100 * tiles->used_share)},
                 {"tiles/runs", "runs", tiles->runs},
                 {"tiles/vertices", tiles->vertices},
                 {"tiles/faces", "most faces", tiles->faces}});
  const bool layers = !s.tiles;
  append(out, {bytesValue("video_bytes", layers ? "video" : "pictures", s.video_bytes),
               bytesValue("geometry_bytes", layers ? "geometry" : "surfaces", s.geometry_bytes),
               bytesValue("label_bytes", layers ? "labels" : "", s.label_bytes),
               {"offset_bytes", layers ? "corrections" : "", s.offset_bytes, of_class(s.offset_bytes)},
               {"alignment_bytes", layers ? "alignment" : "", s.alignment_bytes, of_class(s.alignment_bytes)},
               bytesValue("index_bytes", "index", s.index_bytes),
               {"video_mbit_per_s", layers ? "" : "pictures, Mbit/s", megabitsPerSecond(s, s.video_bytes), 2}});
  if (!layers) out.push_back({"geometry_mbit_per_s", "surfaces, Mbit/s", megabitsPerSecond(s, s.geometry_bytes), 2});
  out.push_back({"total_mbit_per_s", "Mbit/s", megabitsPerSecond(s, streamedBytes(s)), 2});
  return out;
}

void addSequences(const ReportInput& in, Document& page, Json& json) {
  Section section{.id = "sequences", .title = "Sequences"};
  json["notes"] = in.figures.notes;
  for (const std::string& note : in.figures.notes) section.text += note + "\n\n";
  const std::string note =
      fromCameras(in)
          ? "Kept: the share of the cameras' whole pictures that is in the tiled picture. Used: the share of "
            "the tiled picture that shows them. Runs: frames of one topology that follow each other."
          : "";
  const auto rows = report::rowsOf(in.sequences, sequenceValues);
  json["sequences"] = report::jsonOf(rows);
  section.tables = {report::tableOf("", note, rows)};
  page.sections.push_back(std::move(section));
}

void addRenditions(const ReportInput& in, Document& page) {
  if (in.options.lower_renditions.empty()) return;
  std::vector<Values> rows;
  for (const ReportSequence& s : in.sequences)
    for (Values& row : renditionRows(s)) rows.push_back(std::move(row));
  const char* note =
      "The same frames and labels with pictures of other bitrates, and shapes that are coarser where the picture is "
      "smaller, the lowest first; the tables above are of the highest, which poster, alignment and scores use.";
  page.sections.push_back({.id = "renditions", .title = "Renditions", .tables = {report::tableOf("", note, rows)}});
}

Values classValues(const ReportSequence& s, const ClassSummary& c) {
  const auto error = [](const char* key, const char* title, double error_m) {
    return Value(key, title, error_m * 1e3, fixedText(error_m * 1e3, 2) + " mm");
  };
  Json parameters = Json::array();
  for (const auto& p : c.parameters) parameters.push_back({{"name", p.name}, {"min", p.min}, {"max", p.max}});
  const std::string ranges = joined(
      c.parameters, ", ", [](const auto& p) { return p.name + " " + fixedText(p.min, 2) + "…" + fixedText(p.max, 2); });
  return {{"", "class", s.name},
          {"members", "members", c.members, joined(c.members)},
          {"parameters", "parameter", parameters, ranges},
          {"", "phases", s.frames},
          playedSeconds(s),
          {"references", "references", c.references},
          error("linear_error_mm", "linear error", c.linear_error_m),
          error("hybrid_error_mm", "hybrid error", c.hybrid_error_m),
          {"aligned", "alignment", c.aligned, c.aligned ? "baked" : "none"}};
}

void addClasses(const ReportInput& in, Document& page, Json& json) {
  json["classes"] = Json::object();
  std::vector<Values> rows;
  for (const ReportSequence& s : in.sequences) {
    const auto found = in.figures.classes.find(s.name);
    if (found == in.figures.classes.end()) continue;
    rows.push_back(classValues(s, found->second));
    json["classes"][s.name] = report::jsonOf(rows.back());
  }
  if (rows.empty()) return;
  page.sections.push_back(
      {.id = "classes",
       .title = "Motion classes",
       .text = "Members of a class share one video and common time. Meshes are blended linearly, and corrected at the "
               "references towards the non-linear blend; errors are largest vertex distances to it.",
       .tables = {report::tableOf("", "", rows)}});
}

report::Plot residualPlot(const refine::Refinement& r) {
  report::Plot plot{"Distances between outlines", "pixels; left: the mesh is too large", "% of the points"};
  for (const auto& [name, histogram] : {std::pair{"as given", &r.before}, {"refined", &r.after}}) {
    report::Curve curve{name, {}};
    for (size_t i = 0; i < histogram->size(); ++i)
      curve.points.push_back({(double(i) + 0.5) * refine::kBinPixels - refine::kReachPixels, 100 * (*histogram)[i]});
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

std::string refinementText(const ReportInput& in, const refine::Refinement& r) {
  std::string text =
      "The outlines of the mesh against those of the mattes, in " + count(r.frames) + " frames of every camera. ";
  if (r.offsets)
    text += "Every vertex moved along its normal by an offset of its own: half of them by " +
            fixedText(r.offset_median_m * 1e3, 2) + " mm or less, 5 % by less than " +
            fixedText(r.offset_low_m * 1e3, 2) + " mm, 5 % by more than " + fixedText(r.offset_high_m * 1e3, 2) +
            " mm (negative: inwards).";
  if (!r.note.empty()) text += "\n\n" + r.note;
  if (!r.slow.empty())
    text += " They also vary slowly with time in " + joined(r.slow) + ".";
  else if (r.offsets)
    text += " The offsets are the same in all frames.";
  if (!in.refined_cameras.empty())
    text += "\n\nThe changed cameras are in `" + in.refined_cameras +
            "` as a COLMAP text model in the capture's unit. Copy it over the capture's own to keep it.";
  return text;
}

Value residualValue(const char* key, const char* title, const refine::Residuals& r) {
  const Json json{{"points", r.points},
                  {"bias_pixels", r.bias_pixels},
                  {"median_pixels", r.median_pixels},
                  {"p95_pixels", r.p95_pixels}};
  return {key, title, json, fixedText(r.median_pixels, 2) + " / " + fixedText(r.p95_pixels, 2)};
}

Values refinedValues(const refine::CameraRefinement& c) {
  std::string bias = c.measured_bias_pixels ? fixedText(*c.measured_bias_pixels, 2) : "no contrast";
  if (c.used_bias_pixels != 0) bias += ", corrected by " + fixedText(c.used_bias_pixels, 2);
  const auto changed = [&](double value, int digits) { return c.changed ? fixedText(value, digits) : "–"; };
  const glm::dvec3 &turn = c.turn_deg, &deviation = c.turn_deviation_deg;
  Values out{{"name", "camera", c.name},
             {"", "points", c.before.points},
             {"matte_bias_pixels", "bias, px", c.used_bias_pixels, bias},
             residualValue("before", "before, px", c.before),
             residualValue("after", "after, px", c.after)};
  if (c.measured_bias_pixels) out.push_back({"measured_matte_bias_pixels", *c.measured_bias_pixels});
  if (c.best)
    append(out, {{"shift_pixels", "fits best, px", c.best->pixels,
                  fixedText(c.best->pixels, 2) + " ± " + fixedText(c.best->deviation_pixels, 2)},
                 {"shift_deviation_pixels", c.best->deviation_pixels}});
  else
    out.push_back({"", "fits best, px", "–"});
  append(out, {{"changed", c.changed},
               {"turn_deg", "turned, °", {turn.x, turn.y, turn.z}, changed(glm::length(turn), 3)},
               {"turn_deviation_deg", {deviation.x, deviation.y, deviation.z}},
               {"move_mm", "moved, mm", c.move_m * 1e3, changed(c.move_m * 1e3, 1)},
               {"zoom_percent", "zoomed, %", c.zoom_percent, changed(c.zoom_percent, 3)}});
  return out;
}

void addRefinement(const ReportInput& in, Document& page, Json& json) {
  if (!in.figures.refinement) return;
  const refine::Refinement& r = *in.figures.refinement;
  const auto rows = report::rowsOf(r.by_camera, refinedValues);
  json["refinement"] = {
      {"outline", r.options.outline},
      {"cameras", r.options.cameras},
      {"frames", r.frames},
      {"rounds", r.rounds},
      {"moved", bool(r.offsets)},
      {"offset_mm",
       {{"p5", r.offset_low_m * 1e3}, {"median", r.offset_median_m * 1e3}, {"p95", r.offset_high_m * 1e3}}},
      {"varying_sequences", r.slow},
      {"note", r.note},
      {"by_camera", report::jsonOf(rows)}};
  const char* note =
      "px: pixels of the camera's picture. Median and 95 % of the distances' sizes. Bias: how far the matte's edge "
      "lies "
      "outside the edge in the picture; corrected if it is 0.25 px or more.";
  page.sections.push_back({.id = "refinement",
                           .title = "Mesh and cameras against the pictures",
                           .text = refinementText(in, r),
                           .tables = {report::tableOf("", note, rows)},
                           .plots = {residualPlot(r)},
                           .pictures = in.outlines});
}

std::string methodText(const ChosenMethod& chosen) {
  const std::string drawn = "Players draw the character by `" + chosen.method + "` unless they are told otherwise. ";
  if (chosen.choice.verdicts.empty()) return drawn;
  return drawn + "It was chosen on " + count(chosen.views) + " views of " + count(chosen.frames) +
         (chosen.frames == 1 ? " frame" : " frames") +
         ": cameras were left out in turn, drawn from the others, and compared with their pictures. What is drawn "
         "lies " +
         fixedText(chosen.shift_px, 1) +
         " pixels off on average, as a whole; from 2 on the calibration is too far off "
         "for `sweep`. Blended: where two cameras or more share a pixel, with the picture moved to where it fits best; "
         "the choice is made by these. Judged: corrected for what leaving out gets wrong, up to 1 dB more for the "
         "search of `sweep`, the farther the cameras stand apart, .3 dB less for `linear` per pixel off. Figure: all "
         "of it, as drawn. A method may cost " +
         fixedText(chosen.most_cost, 1) + " of FVVR's frames.";
}

Values scoreValues(const MethodVerdict& v) {
  return {{"method", "method", v.score.method},
          {"cost", "FVVR's frames", v.score.cost, 1},
          {"blended_psnr_db", "blended, dB", v.score.psnr_db, 2},
          {"blended_ssim", "SSIM", v.score.ssim, 3},
          {"own_psnr_db", "own view, dB", v.score.own_psnr_db, 2},
          {"judged_psnr_db", "judged, dB", v.judged_db, 2},
          {"figure_psnr_db", "figure, dB", v.score.psnr_fg_db, 2},
          {"figure_ssim", "SSIM", v.score.ssim_fg, 3},
          {"verdict", "verdict", v.verdict}};
}

void addMethod(const ReportInput& in, Document& page, Json& json) {
  if (!in.figures.method) return;
  const ChosenMethod& chosen = *in.figures.method;
  const bool measured = !chosen.choice.verdicts.empty();
  Section section{.id = "method", .title = "Method", .text = methodText(chosen)};
  Values values{{"name", chosen.method}, {"measured", measured}};
  if (chosen.sweep_band_m) values.push_back({"sweep_band_m", *chosen.sweep_band_m});
  if (measured) {
    const auto rows = report::rowsOf(chosen.choice.verdicts, scoreValues);
    append(values, {{"frames", chosen.frames},
                    {"views", chosen.views},
                    {"shift_px", chosen.shift_px},
                    {"gap_deg", chosen.gap_deg},
                    {"most_cost", chosen.most_cost},
                    {"scores", report::jsonOf(rows)}});
    section.tables = {report::tableOf("", "", rows)};
    section.tables[0].columns.back().clear();  // verdicts are sentences
  }
  json["method"] = report::jsonOf(values);
  page.sections.push_back(std::move(section));
}

void addLabels(const ReportInput& in, Document& page, Json& json) {
  json["labels"] = Json::object();
  std::vector<Values> rows;
  for (const auto& [name, s] : in.figures.labels_by_sequence) {
    json["labels"][name] = {{"seam_percent", s.seam_percent},
                            {"flip_percent", s.flip_percent},
                            {"seen_seam_percent", s.seen_seam_percent},
                            {"seen_flip_percent", s.seen_flip_percent},
                            {"mean_penalty", s.mean_penalty},
                            {"energy", s.energy},
                            {"seconds", s.seconds}};
    for (size_t l = 0; l < s.seam_percent.size(); ++l)
      rows.push_back({{"", "sequence", l == 0 ? name : ""},
                      {"", "layer", l + 1},
                      {"", "seam edges", percentText(s.seam_percent[l])},
                      {"", "flips per frame", percentText(s.flip_percent[l])},
                      {"", "seam edges, seen faces", percentText(s.seen_seam_percent[l])},
                      {"", "flips per frame, seen faces", percentText(s.seen_flip_percent[l])},
                      {"", "mean penalty", s.mean_penalty[l], 3}});
  }
  if (!rows.empty())
    page.sections.push_back({.id = "labels", .title = "Labels", .tables = {report::tableOf("", "", rows)}});
}

void addPictures(const ReportInput& in, Document& page, Json& json) {
  json["pictures"] = Json::array();
  for (const ReportPicture& p : in.pictures) json["pictures"].push_back({{"file", p.file}, {"caption", p.caption}});
  if (in.pictures.empty()) return;
  page.poster = in.pictures[0];
  if (in.pictures.size() > 1)
    page.sections.push_back(
        {.id = "pictures", .title = "Pictures", .pictures = {in.pictures.begin() + 1, in.pictures.end()}});
}

// Options of texture layers, in the order of the page.
Values layerValues(const ReportInput& in) {
  constexpr const char *kPenalties[] = {"axis", "ray", "resolution"}, *kFilters[] = {"bilinear", "mipmap", "bicubic"};
  const BakeOptions& o = in.options;
  const std::string moved = o.refine.outline ? "mesh moved to the mattes' outlines" : "mesh as given";
  return {{"options/layers", "layers", o.layers},
          {"options/texture", "texture", o.texture,
           count(o.texture) + (o.equal_layers ? " texels, all layers" : " texels, further layers half of it")},
          {"options/equal_layers", o.equal_layers},
          {"", "mesh and cameras",
           moved + (o.refine.cameras ? ", cameras corrected where the mattes contradict them" : ", cameras as given")},
          {"options/labels", "labels", o.labels->name},
          {"options/penalty", "penalty", kPenalties[static_cast<int>(o.penalty)]},
          {"options/filter", "resampling filter", kFilters[static_cast<int>(o.resample.filter)]},
          {"options/classes", o.classes.bake},
          {"options/align", o.classes.align ? "baked" : "none"},
          {"options/blend_error_mm", *o.classes.blend_error_m * 1e3},
          {"options/alignment_step_m", *o.classes.alignment_step_m}};
}

Values cameraValues(const CameraOptions& o) {
  return {{"options/appearance", "cameras"},
          {"options/tile_scale", "tile scale", o.tile_scale, fixedText(o.tile_scale, 2) + " texels per pixel"},
          {"options/max_texels", o.max_texels},
          {"options/faces", o.faces},
          {"options/method", o.method.empty() ? "auto" : o.method},
          {"options/method_cost", o.choice.most_cost}};
}

void addSettings(const ReportInput& in, Document& page, Json& json) {
  const BakeOptions& o = in.options;
  const bool layers = !fromCameras(in);
  const auto lower = report::rowsOf(o.lower_renditions, [](const LowerRendition& r) {
    return Values{{"size", r.size}, {"crf", r.crf}, {"codec", encode::infoOf(r.codec).name}, {"preset", r.preset}};
  });
  Values values{{"generator", in.generator},
                {"capture/name", in.capture_name},
                {"capture/credit", in.credit},
                {"cameras", "cameras", in.cameras},
                {"vertices", in.vertices},
                {"faces", layers ? "mesh" : "surfaces", in.faces,
                 (layers ? "" : "up to ") + count(in.faces) + " faces, " + count(in.vertices) + " vertices"},
                {"picture/width", in.picture_width},
                {"picture/height", layers ? "tiled picture" : "", in.picture_height,
                 textureSize(in.picture_width, in.picture_height) + " texels"},
                {"options/sequences", o.sequences}};
  append(values, layers ? layerValues(in) : cameraValues(o.cameras));
  append(
      values,
      {{"options/refine", o.refine.outline ? "outline" : "none"},
       {"options/refine_cameras", o.refine.cameras},
       {"options/colour_calibration", "colour calibration", o.colour_calibration, o.colour_calibration ? "on" : "off"},
       {"codec", "codec", in.codec, in.codec + ", CRF " + count(o.crf) + ", GOP ≤ " + count(o.gop) + " frames"},
       {"options/crf", o.crf},
       {"options/gop", o.gop},
       {"options/position_step_m", "vertex step", *o.position_step_m, fixedText(*o.position_step_m * 1e3, 3) + " mm"}});
  if (layers)
    values.push_back({"options/gutter_texels", "gutter", o.gutter_texels, count(o.gutter_texels) + " texels"});
  append(values, {{"options/jobs", "jobs", o.jobs},
                  {"options/preset", o.preset},
                  {"options/lower_renditions", report::jsonOf(lower)}});
  for (const auto& [library, version] : in.versions) values.push_back({"versions/" + library, library, version});
  json.update(report::jsonOf(values));
  page.sections.push_back({.id = "settings", .title = "Settings", .tables = {report::factsOf(values)}});
}

}  // namespace

Status writeReport(const std::string& folder, const ReportInput& in) {
  Document page{.title = in.capture_name, .credit = in.credit};
  page.subtitle = "Baked by " + in.generator + " from " + count(in.cameras) + " cameras into " +
                  (fromCameras(in) ? "one tiled picture of the performer."
                                   : count(in.options.layers) + " view-dependent texture layers.");
  Json json;
  addSummary(in, page, json);
  addStages(in, page, json);
  addSizes(in, page, json);
  addSequences(in, page, json);
  addRenditions(in, page);
  addClasses(in, page, json);
  addRefinement(in, page, json);
  addMethod(in, page, json);
  addLabels(in, page, json);
  addPictures(in, page, json);
  addSettings(in, page, json);
  return report::writeReport(folder, "report", page, json);
}

}  // namespace fourdvt::bake
