// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.h"
#include "jobs/records.h"
#include "report/document.h"
#include "report/values.h"

namespace fourdvt::jobs {
namespace {

using report::bytesText, report::fixedText, report::Json, report::Value, report::Values;

constexpr size_t kListed = 20;  // maximum number of rows: slowest pieces, and pieces with several starts

// "12.3 s", "4 min 05 s", "2 h 03 min"
std::string durationText(double seconds) {
  if (seconds < 60) return report::secondsText(seconds);
  const auto whole = static_cast<long long>(std::llround(seconds));
  return whole < 3600 ? printed("%lld min %02lld s", whole / 60, whole % 60)
                      : printed("%lld h %02lld min", whole / 3600, whole / 60 % 60);
}

struct Kind {
  std::string name;
  size_t pieces = 0, done = 0, starts = 0;
  double seconds = 0, cpu_s = 0, slowest_s = 0, peak_mb = 0, planned_mb = 0, read_mb = 0, planned_s = 0;
};

struct Sums {
  std::vector<Kind> kinds;  // order of the plan
  Kind all;
  std::vector<const Record*> records;  // slowest first
  std::vector<std::string> over;       // ids of pieces that exceeded the planned memory
  double expected_s = 0;               // planned duration of the finished pieces
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

// Number of starts without a result.
size_t lost(const Kind& kind) { return kind.starts - std::min(kind.starts, kind.done); }

Value durationValue(const char* key, const char* title, double seconds) {
  return {key, title, seconds, durationText(seconds)};
}

Values valuesOf(const Kind& k) {
  const double n = double(std::max<size_t>(k.done, 1));
  return {{"", "kind", k.name},
          {"pieces", k.pieces},
          {"done", "pieces", k.done, std::to_string(k.done) + " of " + std::to_string(k.pieces)},
          durationValue("seconds", "sum", k.seconds),
          durationValue("", "mean", k.seconds / n),
          durationValue("slowest_s", "slowest", k.slowest_s),
          durationValue("cpu_s", "processor", k.cpu_s),
          {"peak_mb", "memory, MB", k.peak_mb, fixedText(k.peak_mb, 0) + " of " + fixedText(k.planned_mb, 0)},
          {"read_mb", "read", k.read_mb, bytesText(k.read_mb / n * 1e6)},
          {"planned_s", k.planned_s},
          {"starts", "lost starts", k.starts, std::to_string(lost(k))}};
}

Values valuesOf(const Plan& plan, const Sums& sums) {
  const double minutes = plan.capture_s / 60;
  std::set<std::string> hosts;
  for (const Record* r : sums.records) hosts.insert(r->host);
  return {{"command", plan.command},
          {"capture", plan.capture},
          {"frames", plan.frames},
          {"capture_s", plan.capture_s},
          {"tool/version", plan.tool.version},
          {"tool/build", plan.tool.build},
          durationValue("seconds", "of pieces", sums.all.seconds),
          {"", "per minute of capture", minutes > 0 ? durationText(sums.all.seconds / minutes) : "–"},
          durationValue("", "of processors", sums.all.cpu_s),
          {"", hosts.size() == 1 ? "machine" : "machines", hosts.size()},
          {"lost_starts", "starts without a result", lost(sums.all)},
          {"over_memory", "pieces over their memory", sums.over, std::to_string(sums.over.size())}};
}

report::Section costSection(const Sums& sums, const Values& values, const std::vector<Values>& kinds) {
  report::Section cost{"cost", "Cost", "Seconds are of the pieces' wall clocks, added up; several run at once."};
  cost.tiles = report::tilesOf(values);
  std::vector<Values> rows = kinds;
  rows.push_back(valuesOf(sums.all));
  cost.tables = {report::tableOf(
      "By kind", "Memory: the most of a piece, megabytes, of what the plan allows. Read: mean of a piece.", rows)};
  report::BarChart chart{"Seconds by kind"};
  for (const Kind& kind : sums.kinds) chart.bars.push_back({kind.name, durationText(kind.seconds), kind.seconds});
  cost.bar_charts.push_back(std::move(chart));
  return cost;
}

report::Section slowestSection(const Plan& plan, const Sums& sums) {
  std::vector<Values> rows;
  for (size_t i = 0; i < std::min(kListed, sums.records.size()); ++i) {
    const Record& r = *sums.records[i];
    rows.push_back({{"", "piece", r.id},
                    {"", "machine", r.host},
                    durationValue("", "seconds", r.seconds),
                    durationValue("", "planned", plan.find(r.id)->seconds),
                    {"", "memory, MB", r.peak_mb, 0},
                    {"", "read", bytesText(r.read_mb * 1e6)},
                    {"", "start", r.attempt}});
  }
  return {.id = "slowest", .title = "Slowest pieces", .tables = {report::tableOf("", "", rows)}};
}

report::Section againSection(const Progress& progress) {
  std::vector<Values> rows;
  for (const auto& [id, count] : progress.attempts)
    if (count > 1 && rows.size() < kListed)
      rows.push_back({{"", "piece", id}, {"", "starts", count}, {"", "done", progress.done.count(id) ? "yes" : "no"}});
  report::Section again{"again", "Started more than once", "None."};
  if (rows.empty()) return again;
  again.text =
      "A start that is not followed by a result was killed, ran out of something, or failed: `logs/` has what it "
      "printed.";
  again.tables = {report::tableOf("", "", rows)};
  return again;
}

}  // namespace

Status writeReport(const std::string& job_folder, const Plan& plan, const Progress& progress) {
  const Sums sums = summed(plan, progress);
  const Values values = valuesOf(plan, sums);
  const auto kinds = report::rowsOf(sums.kinds, [](const Kind& k) { return valuesOf(k); });
  Json json = report::jsonOf(values);
  for (size_t k = 0; k < kinds.size(); ++k) json["kinds"][sums.kinds[k].name] = report::jsonOf(kinds[k]);
  const report::Document page{
      "Job: " + plan.command + " of " + plan.capture,
      progressLine(plan, progress) + " · fourdvt " + plan.tool.version + ", build " + plan.tool.build,
      {costSection(sums, values, kinds), slowestSection(plan, sums), againSection(progress)}};
  return report::writeReport(job_folder, "job", page, json);
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
