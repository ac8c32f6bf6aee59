// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/report.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "bake/run/stage_table.h"
#include "base/html_text.h"

namespace fourdvt::bake {
namespace {

using Json = nlohmann::ordered_json;
using StageSeconds = std::vector<std::pair<std::string, double>>;

std::string printed(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string sizeText(uint64_t bytes) {
  if (bytes < 1000) return std::to_string(bytes) + " B";
  if (bytes < 1000 * 1000) return printed("%.1f kB", bytes / 1e3);
  return printed("%.2f MB", bytes / 1e6);
}

std::string secondsText(double s) {
  if (s < 0.01) return printed("%.2f ms", s * 1e3);
  return s < 1 ? printed("%.0f ms", s * 1e3) : printed("%.2f s", s);
}

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

Json optionsJson(const BakeOptions& o) {
  return {{"sequences", o.sequences},
          {"layers", o.layers},
          {"texture", o.texture},
          {"crf", o.crf},
          {"gop", o.gop},
          {"jobs", o.jobs},
          {"position_step_m", o.position_step_m},
          {"gutter_texels", o.gutter_texels},
          {"labels", labelModeName(o.labels)},
          {"penalty", penaltyName(o.penalty)},
          {"filter", filterName(o.resample.filter)},
          {"equal_layers", o.equal_layers},
          {"colour_calibration", o.colour_calibration},
          {"classes", o.classes},
          {"align", o.align ? "baked" : "none"},
          {"blend_error_mm", o.blend_error_m * 1e3},
          {"alignment_step_m", o.alignment_step_m},
          {"preset", o.preset}};
}

Json sequenceJson(const ReportSequence& s) {
  return {{"name", s.name},
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
}

Json classJson(const ClassFigures& c) {
  Json json = {{"members", c.members},
               {"references", c.references},
               {"linear_error_mm", c.linear_error_m * 1e3},
               {"hybrid_error_mm", c.hybrid_error_m * 1e3},
               {"aligned", c.aligned}};
  json["parameters"] = Json::array();
  for (const auto& p : c.parameters) json["parameters"].push_back({{"name", p.name}, {"min", p.min}, {"max", p.max}});
  return json;
}

// Horizontal bars with labels and values; one row an entry, widths relative to the largest.
struct Bar {
  std::string label, text;
  double value;
};

std::string barChart(const std::vector<Bar>& bars, const char* title) {
  constexpr int kRow = 30, kLabel = 120, kWidth = 640, kValue = 120;
  double largest = 1e-12;
  for (const Bar& bar : bars) largest = std::max(largest, bar.value);
  const int height = kRow * static_cast<int>(bars.size());
  std::string out = "<svg viewBox=\"0 0 " + std::to_string(kWidth) + " " + std::to_string(height) +
                    "\" role=\"img\" aria-label=\"" + htmlEscaped(title) + "\">\n";
  for (size_t i = 0; i < bars.size(); ++i) {
    const int y = kRow * static_cast<int>(i);
    const double length = std::max(1.0, (kWidth - kLabel - kValue) * bars[i].value / largest);
    out += "<text class=\"label\" x=\"" + std::to_string(kLabel - 12) + "\" y=\"" + std::to_string(y + 19) + "\">" +
           htmlEscaped(bars[i].label) + "</text><rect x=\"" + std::to_string(kLabel) + "\" y=\"" +
           std::to_string(y + 5) + "\" width=\"" + printed("%.1f", length) +
           "\" height=\"18\" rx=\"3\"/><text class=\"value\" x=\"" + printed("%.1f", kLabel + length + 8) + "\" y=\"" +
           std::to_string(y + 19) + "\">" + htmlEscaped(bars[i].text) + "</text>\n";
  }
  return out + "</svg>\n";
}

std::string stageChart(const ReportInput& in) {
  std::vector<Bar> bars;
  const double frames = std::max(1u, in.figures.frames);
  for (const auto& [stage, s] : orderedStages(in)) bars.push_back({stage, secondsText(s / frames), s / frames});
  return barChart(bars, "Seconds per frame by stage");
}

std::string sizeChart(const ReportInput& in) {
  std::vector<Bar> bars;
  const double total = std::max<double>(1, static_cast<double>(totalBytes(in)));
  for (const auto& [part, bytes] : in.figures.bytes_by_part)
    bars.push_back({part, sizeText(bytes) + printed(" · %.1f %%", 100 * bytes / total), static_cast<double>(bytes)});
  std::sort(bars.begin(), bars.end(), [](const Bar& a, const Bar& b) { return a.value > b.value; });
  return barChart(bars, "Bytes by part");
}

std::string tile(const std::string& value, const std::string& meaning) {
  return "<div class=\"tile\"><b>" + htmlEscaped(value) + "</b><span>" + htmlEscaped(meaning) + "</span></div>\n";
}

std::string tiles(const ReportInput& in) {
  const double frames = std::max(1u, in.figures.frames);
  double peak_rate = 0;
  for (const ReportSequence& s : in.sequences) peak_rate = std::max(peak_rate, megabitsPerSecond(s, streamedBytes(s)));
  std::string out = "<section class=\"tiles\">\n";
  out += tile(sizeText(totalBytes(in)), "whole character");
  out += tile(printed("%.2f Mbit/s", peak_rate), "busiest sequence, all streams");
  out += tile(std::to_string(in.figures.frames),
              in.sequences.size() == 1 ? "frames in 1 sequence"
                                       : "frames in " + std::to_string(in.sequences.size()) + " sequences");
  out += tile(secondsText(in.wall_s / frames), in.resumed ? "a frame, of a resumed run" : "a frame, whole bake");
  if (in.figures.peak_rss_bytes) out += tile(printed("%.0f MB", in.figures.peak_rss_bytes / 1e6), "peak memory");
  return out + "</section>\n";
}

std::string cell(const std::string& text) { return "<td>" + htmlEscaped(text) + "</td>"; }

std::string sequenceTable(const ReportInput& in) {
  std::string out =
      "<div "
      "class=\"scroll\"><table><thead><tr><th>sequence</th><th>frames</th><th>seconds</th><th>GOPs</th><th>video</th>"
      "<th>geometry</th><th>labels</th><th>corrections</th><th>alignment</th><th>index</th><th>Mbit/s</th></tr></thead>"
      "<tbody>\n";
  for (const ReportSequence& s : in.sequences) {
    out += "<tr>" + cell(s.name + (s.loop ? " ↻" : "")) + cell(std::to_string(s.frames)) +
           cell(printed("%.2f", s.fps > 0 ? s.frames / s.fps : 0)) + cell(std::to_string(s.gops)) +
           cell(sizeText(s.video_bytes)) + cell(sizeText(s.geometry_bytes)) + cell(sizeText(s.label_bytes)) +
           cell(s.members > 1 ? sizeText(s.offset_bytes) : "–") +
           cell(s.members > 1 ? sizeText(s.alignment_bytes) : "–") + cell(sizeText(s.index_bytes)) +
           cell(printed("%.2f", megabitsPerSecond(s, streamedBytes(s)))) + "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string rangeText(const ClassFigures& c) {
  std::string text;
  for (const auto& p : c.parameters)
    text += (text.empty() ? "" : ", ") + p.name + printed(" %.2f", p.min) + printed("…%.2f", p.max);
  return text;
}

std::string classTable(const ReportInput& in) {
  std::string out =
      "<p>Members of a class share one video and common time. Meshes are blended linearly, and corrected at the "
      "references towards the non-linear blend; errors are largest vertex distances to it.</p>\n"
      "<div class=\"scroll\"><table><thead><tr><th>class</th><th>members</th><th>parameter</th><th>phases</th>"
      "<th>seconds</th><th>references</th><th>linear error</th><th>hybrid error</th><th>alignment</th></tr></thead>"
      "<tbody>\n";
  for (const ReportSequence& s : in.sequences) {
    const auto found = in.figures.classes.find(s.name);
    if (found == in.figures.classes.end()) continue;
    const ClassFigures& c = found->second;
    std::string members;
    for (const std::string& name : c.members) members += (members.empty() ? "" : ", ") + name;
    out += "<tr>" + cell(s.name) + cell(members) + cell(rangeText(c)) + cell(std::to_string(s.frames)) +
           cell(printed("%.2f", s.fps > 0 ? s.frames / s.fps : 0)) + cell(std::to_string(c.references)) +
           cell(printed("%.2f mm", c.linear_error_m * 1e3)) + cell(printed("%.2f mm", c.hybrid_error_m * 1e3)) +
           cell(c.aligned ? "baked" : "none") + "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string labelTable(const ReportInput& in) {
  std::string out =
      "<div class=\"scroll\"><table><thead><tr><th>sequence</th><th>layer</th><th>seam edges</th><th>flips per "
      "frame</th>"
      "<th>seam edges, seen faces</th><th>flips per frame, seen faces</th><th>mean penalty</th></tr></thead><tbody>\n";
  for (const auto& [name, s] : in.figures.labels_by_sequence)
    for (size_t l = 0; l < s.seam_percent.size(); ++l)
      out += "<tr>" + cell(l == 0 ? name : "") + cell(std::to_string(l + 1)) +
             cell(printed("%.2f %%", s.seam_percent[l])) + cell(printed("%.2f %%", s.flip_percent[l])) +
             cell(printed("%.2f %%", s.seen_seam_percent[l])) + cell(printed("%.2f %%", s.seen_flip_percent[l])) +
             cell(printed("%.3f", s.mean_penalty[l])) + "</tr>\n";
  return out + "</tbody></table></div>\n";
}

std::string factsTable(const ReportInput& in) {
  const BakeOptions& o = in.options;
  std::vector<std::pair<std::string, std::string>> rows = {
      {"cameras", std::to_string(in.cameras)},
      {"mesh", std::to_string(in.faces) + " faces, " + std::to_string(in.vertices) + " vertices"},
      {"tiled picture", std::to_string(in.picture_width) + " × " + std::to_string(in.picture_height) + " texels"},
      {"layers", std::to_string(o.layers)},
      {"texture",
       std::to_string(o.texture) + (o.equal_layers ? " texels, all layers" : " texels, further layers half of it")},
      {"labels", labelModeName(o.labels)},
      {"penalty", penaltyName(o.penalty)},
      {"resampling filter", filterName(o.resample.filter)},
      {"colour calibration", o.colour_calibration ? "on" : "off"},
      {"codec", in.codec + ", CRF " + std::to_string(o.crf) + ", GOP ≤ " + std::to_string(o.gop) + " frames"},
      {"vertex step", printed("%.3f mm", o.position_step_m * 1e3)},
      {"gutter", std::to_string(o.gutter_texels) + " texels"},
      {"jobs", std::to_string(o.jobs)}};
  for (const auto& version : in.versions) rows.push_back(version);
  std::string out = "<div class=\"scroll\"><table class=\"facts\"><tbody>\n";
  for (const auto& [name, value] : rows) out += "<tr><th>" + htmlEscaped(name) + "</th>" + cell(value) + "</tr>\n";
  return out + "</tbody></table></div>\n";
}

std::string figure(const ReportPicture& p) {
  return "<figure><img loading=\"lazy\" src=\"" + htmlEscaped(p.file) + "\" alt=\"" + htmlEscaped(p.caption) +
         "\"><figcaption>" + htmlEscaped(p.caption) + "</figcaption></figure>\n";
}

constexpr const char* kStyle = R"(
:root{--ink:#1d2126;--soft:#68717c;--line:#dfe2e5;--paper:#f6f5f2;--card:#fff;--bar:#3f6f8f;color-scheme:light dark}
@media(prefers-color-scheme:dark){:root{--ink:#e8eaec;--soft:#98a1ab;--line:#30363d;--paper:#14171a;--card:#1c2024;--bar:#6fa6c8}}
*{box-sizing:border-box}body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
main{max-width:1040px;margin:0 auto;padding:clamp(20px,5vw,56px)}
header{display:grid;grid-template-columns:minmax(0,1fr) minmax(0,280px);gap:32px;align-items:end}
header figure{margin:0}h1{font-size:clamp(28px,5vw,44px);line-height:1.1;margin:0 0 8px;font-weight:650;letter-spacing:-.02em}
h2{font-size:18px;margin:44px 0 14px;font-weight:620}p{margin:0 0 8px;color:var(--soft);max-width:62ch}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:1px;background:var(--line);border:1px solid var(--line);
border-radius:10px;overflow:hidden;margin-top:32px}.tile{background:var(--card);padding:16px 18px}
.tile b{display:block;font-size:22px;font-weight:620;font-variant-numeric:tabular-nums}.tile span{color:var(--soft);font-size:13px}
svg{width:100%;max-width:720px;height:auto;display:block}svg rect{fill:var(--bar)}svg text{font:13px system-ui,sans-serif;fill:var(--ink)}
svg .label{text-anchor:end;fill:var(--soft)}svg .value{font-variant-numeric:tabular-nums}
.scroll{overflow-x:auto}table{border-collapse:collapse;width:100%;font-size:14px;font-variant-numeric:tabular-nums}
th,td{text-align:right;padding:8px 10px;border-bottom:1px solid var(--line);white-space:nowrap}th{color:var(--soft);font-weight:500}
th:first-child,td:first-child{text-align:left}.facts td{text-align:left}.facts{max-width:640px}.facts th{width:180px}
.sheet{display:grid;grid-template-columns:repeat(auto-fill,minmax(220px,1fr));gap:18px}figure{margin:0}
img{width:100%;display:block;border-radius:8px;background:#0002}figcaption{font-size:13px;color:var(--soft);margin-top:6px}
footer{margin-top:48px;border-top:1px solid var(--line);padding-top:16px}
@media(max-width:640px){header{grid-template-columns:1fr}}
)";

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
  std::string out =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>" +
      htmlEscaped(in.capture_name) + " – bake report</title><style>" + kStyle +
      "</style></head><body><main>\n<header><div><h1>" + htmlEscaped(in.capture_name) + "</h1><p>Baked by " +
      htmlEscaped(in.generator) + " from " + std::to_string(in.cameras) + " cameras into " +
      std::to_string(in.options.layers) + " view-dependent texture layers.</p></div>\n";
  if (!in.pictures.empty()) out += figure(in.pictures.front());
  out += "</header>\n" + tiles(in);
  out += "<h2>Seconds per frame, by stage</h2>\n";
  if (in.resumed) out += "<p>This run resumed an interrupted one: it measured only the GOPs it baked itself.</p>\n";
  out += "<p>Stages overlap on " + std::to_string(in.options.jobs) +
         " jobs: their sum may exceed the whole bake’s time.</p>\n";
  out += stageChart(in) + "<h2>What the bytes are</h2>\n" + sizeChart(in) + "<h2>Sequences</h2>\n" + sequenceTable(in);
  for (const std::string& note : in.figures.notes) out += "<p>" + htmlEscaped(note) + "</p>\n";
  if (!in.figures.classes.empty()) out += "<h2>Motion classes</h2>\n" + classTable(in);
  if (!in.figures.labels_by_sequence.empty()) out += "<h2>Labels</h2>\n" + labelTable(in);
  if (in.pictures.size() > 1) {
    out += "<h2>Pictures</h2>\n<section class=\"sheet\">\n";
    for (size_t i = 1; i < in.pictures.size(); ++i) out += figure(in.pictures[i]);
    out += "</section>\n";
  }
  out += "<h2>Settings</h2>\n" + factsTable(in);
  if (!in.credit.empty()) out += "<footer><p>" + htmlEscaped(in.credit) + "</p></footer>\n";
  return out + "</main></body></html>\n";
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
