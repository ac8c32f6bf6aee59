// SPDX-License-Identifier: Apache-2.0
#include "jobs/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "platform/files.h"
#include "report/document.h"
#include "report/text.h"

namespace fourdvt::jobs {
namespace {

using Json = nlohmann::ordered_json;
using report::bytesText;
using report::fixedText;

constexpr size_t kListed = 20;  // slowest pieces, and pieces that were started again

// "12.3 s", "4 min 05 s", "2 h 03 min"
std::string durationText(double seconds) {
  if (seconds < 60) return report::secondsText(seconds);
  const auto whole = static_cast<long long>(std::llround(seconds));
  char text[40];
  if (whole < 3600)
    std::snprintf(text, sizeof text, "%lld min %02lld s", whole / 60, whole % 60);
  else
    std::snprintf(text, sizeof text, "%lld h %02lld min", whole / 3600, whole / 60 % 60);
  return text;
}

struct Kind {
  std::string name;
  size_t pieces = 0, done = 0, starts = 0;
  double seconds = 0, cpu_s = 0, slowest_s = 0, peak_mb = 0, planned_mb = 0, read_mb = 0, planned_s = 0;
};

struct Sums {
  std::vector<Kind> kinds;  // in the plan's order
  Kind all;
  std::vector<const Record*> records;  // the slowest first
  std::vector<std::string> over;       // ids of pieces that took more memory than planned
  double expected_s = 0;               // of the pieces that are done, by the plan
};

void add(const Piece& piece, const Record* record, uint32_t starts, Kind& kind) {
  ++kind.pieces;
  kind.starts += starts;
  kind.planned_s += piece.seconds;
  kind.planned_mb = std::max(kind.planned_mb, piece.memory_mb);
  if (!record) return;
  ++kind.done;
  kind.seconds += record->seconds;
  kind.cpu_s += record->cpu_s;
  kind.slowest_s = std::max(kind.slowest_s, record->seconds);
  kind.peak_mb = std::max(kind.peak_mb, record->peak_mb);
  kind.read_mb += record->read_mb;
}

Sums summed(const Plan& plan, const Progress& progress) {
  Sums out;
  out.all.name = "all";
  for (const Piece& piece : plan.pieces) {
    auto kind = std::find_if(out.kinds.begin(), out.kinds.end(), [&](const Kind& k) { return k.name == piece.kind; });
    if (kind == out.kinds.end()) {
      out.kinds.push_back({piece.kind});
      kind = out.kinds.end() - 1;
    }
    const auto found = progress.done.find(piece.id);
    const Record* record = found == progress.done.end() ? nullptr : &found->second;
    const auto starts = progress.attempts.find(piece.id);
    for (Kind* k : {&*kind, &out.all}) add(piece, record, starts == progress.attempts.end() ? 0 : starts->second, *k);
    if (!record) continue;
    out.records.push_back(record);
    out.expected_s += piece.seconds;
    if (record->peak_mb > piece.memory_mb) out.over.push_back(piece.id);
  }
  std::stable_sort(out.records.begin(), out.records.end(),
                   [](const Record* a, const Record* b) { return a->seconds > b->seconds; });
  return out;
}

// Starts that ended without a result.
size_t lost(const Kind& kind) { return kind.starts - std::min(kind.starts, kind.done); }

std::vector<std::string> rowOf(const Kind& k) {
  const double n = double(std::max<size_t>(k.done, 1));
  return {k.name,
          std::to_string(k.done) + " of " + std::to_string(k.pieces),
          durationText(k.seconds),
          durationText(k.seconds / n),
          durationText(k.slowest_s),
          durationText(k.cpu_s),
          fixedText(k.peak_mb, 0) + " of " + fixedText(k.planned_mb, 0),
          bytesText(k.read_mb / n * 1e6),
          std::to_string(lost(k))};
}

report::Document documentOf(const Plan& plan, const Progress& progress, const Sums& sums) {
  const Kind& all = sums.all;
  const double minutes = plan.capture_s / 60;
  std::set<std::string> hosts;
  for (const Record* r : sums.records) hosts.insert(r->host);
  report::Document document;
  document.title = "Job: " + plan.command + " of " + plan.capture;
  document.subtitle = progressLine(plan, progress) + " · fourdvt " + plan.tool.version + ", build " + plan.tool.build;
  report::Section cost{"cost", "Cost", "Seconds are of the pieces' wall clocks, added up; several run at once."};
  cost.tiles = {{durationText(all.seconds), "of pieces"},
                {minutes > 0 ? durationText(all.seconds / minutes) : "–", "per minute of capture"},
                {durationText(all.cpu_s), "of processors"},
                {std::to_string(hosts.size()), hosts.size() == 1 ? "machine" : "machines"},
                {std::to_string(lost(all)), "starts without a result"},
                {std::to_string(sums.over.size()), "pieces over their memory"}};
  report::Table kinds{"By kind",
                      "Memory: the most of a piece, megabytes, of what the plan allows. Read: mean of a piece."};
  kinds.columns = {"kind", "pieces", "sum", "mean", "slowest", "processor", "memory, MB", "read", "lost starts"};
  for (const Kind& kind : sums.kinds) kinds.rows.push_back(rowOf(kind));
  kinds.rows.push_back(rowOf(all));
  cost.tables.push_back(std::move(kinds));
  report::BarChart chart{"Seconds by kind"};
  for (const Kind& kind : sums.kinds) chart.bars.push_back({kind.name, durationText(kind.seconds), kind.seconds});
  cost.bar_charts.push_back(std::move(chart));
  report::Section slowest{"slowest", "Slowest pieces", ""};
  report::Table table{"", ""};
  table.columns = {"piece", "machine", "seconds", "planned", "memory, MB", "read", "start"};
  for (size_t i = 0; i < std::min(kListed, sums.records.size()); ++i) {
    const Record& r = *sums.records[i];
    table.rows.push_back({r.id, r.host, durationText(r.seconds), durationText(plan.find(r.id)->seconds),
                          fixedText(r.peak_mb, 0), bytesText(r.read_mb * 1e6), std::to_string(r.attempt)});
  }
  slowest.tables.push_back(std::move(table));
  report::Section again{"again", "Started more than once", "None."};
  report::Table starts{"", ""};
  starts.columns = {"piece", "starts", "done"};
  for (const auto& [id, count] : progress.attempts)
    if (count > 1 && starts.rows.size() < kListed)
      starts.rows.push_back({id, std::to_string(count), progress.done.count(id) ? "yes" : "no"});
  if (!starts.rows.empty())
    again.text =
        "A start that is not followed by a result was killed, ran out of something, or failed: `logs/` has what it "
        "printed.",
    again.tables.push_back(std::move(starts));
  document.sections = {std::move(cost), std::move(slowest), std::move(again)};
  return document;
}

Json jsonOf(const Plan& plan, const Sums& sums) {
  Json json;
  json["command"] = plan.command;
  json["capture"] = plan.capture;
  json["frames"] = plan.frames;
  json["capture_s"] = plan.capture_s;
  json["tool"] = {{"version", plan.tool.version}, {"build", plan.tool.build}};
  for (const Kind& k : sums.kinds)
    json["kinds"][k.name] = {{"pieces", k.pieces},   {"done", k.done},       {"starts", k.starts},
                             {"seconds", k.seconds}, {"cpu_s", k.cpu_s},     {"slowest_s", k.slowest_s},
                             {"peak_mb", k.peak_mb}, {"read_mb", k.read_mb}, {"planned_s", k.planned_s}};
  json["over_memory"] = sums.over;
  json["seconds"] = sums.all.seconds;
  json["lost_starts"] = lost(sums.all);
  return json;
}

}  // namespace

Status writeReport(const std::string& job_folder, const Plan& plan, const Progress& progress) {
  const Sums sums = summed(plan, progress);
  FOURDVT_TRY(platform::writeFileAtomic(job_folder + "/" + kReportJson, jsonOf(plan, sums).dump(1) + "\n"));
  return platform::writeFileAtomic(job_folder + "/" + kReportHtml,
                                   report::documentHtml(documentOf(plan, progress, sums)));
}

std::string progressLine(const Plan& plan, const Progress& progress) {
  const Sums sums = summed(plan, progress);
  std::string line = std::to_string(sums.all.done) + " of " + std::to_string(sums.all.pieces) + " pieces";
  if (const size_t starts = lost(sums.all); starts > 0)
    line += ", " + std::to_string(starts) + (starts == 1 ? " start" : " starts") + " without a result yet";
  const double left = sums.all.planned_s - sums.expected_s;
  const double pace = sums.expected_s > 0 ? sums.all.seconds / sums.expected_s : 1;
  if (left > 0) line += ", about " + durationText(left * pace) + " of work left";
  return line;
}

}  // namespace fourdvt::jobs
