// SPDX-License-Identifier: Apache-2.0
#include "lab/study/run/row_writer.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "lab/study/run/rows.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr const char* kHeader = "table,sequence,method,setting,quantity,value,unit";
constexpr size_t kFields = 7;

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

std::string number(double value) { return printed("%.10g", value); }

// Splits CSV text into records; false if a quoted field does not end.
bool splitCsv(const std::string& text, std::vector<std::vector<std::string>>& records) {
  std::vector<std::string> record(1);
  bool in_quotes = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_quotes) {
      if (c != '"') {
        record.back() += c;
      } else if (i + 1 < text.size() && text[i + 1] == '"') {
        record.back() += text[++i];
      } else {
        in_quotes = false;
      }
    } else if (c == '"') {
      in_quotes = true;
    } else if (c == ',') {
      record.emplace_back();
    } else if (c == '\n') {
      records.push_back(std::move(record));
      record.assign(1, {});
    } else if (c != '\r') {
      record.back() += c;
    }
  }
  if (record.size() > 1 || !record.back().empty()) records.push_back(std::move(record));
  return !in_quotes;
}

bool parseNumber(const std::string& text, double& value) {
  char* end = nullptr;
  value = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == 0;
}

}  // namespace

std::string rowsCsv(const Rows& rows) {
  std::string out = std::string(kHeader) + "\n";
  for (const Row& f : rows)
    out += quoted(f.table) + "," + quoted(f.sequence) + "," + quoted(f.method) + "," + quoted(f.setting) + "," +
           quoted(f.quantity) + "," + number(f.value) + "," + quoted(f.unit) + "\n";
  return out;
}

std::string rowsJson(const Rows& rows, const StudyOptions& options, const std::string& capture_name) {
  using Json = nlohmann::ordered_json;
  const auto replaced = Json::error_handler_t::replace;  // replaces bytes that are not UTF-8
  const Json run = {{"generator", options.generator},
                    {"capture", capture_name},
                    {"quick", options.quick},
                    {"sequences", options.sequences},
                    {"jobs", options.jobs}};
  std::string out = run.dump(-1, ' ', false, replaced);
  out.replace(out.size() - 1, 1, ",\"rows\":[");
  for (const Row& f : rows) {
    const Json row = {{"table", f.table},       {"sequence", f.sequence}, {"method", f.method}, {"setting", f.setting},
                      {"quantity", f.quantity}, {"value", f.value},       {"unit", f.unit}};
    out += (&f == &rows.front() ? "\n" : ",\n") + row.dump(-1, ' ', false, replaced);
  }
  return out + "\n]}\n";
}

const char* rows::unitOf(const std::string& quantity) {
  static constexpr std::pair<const char*, const char*> kByName[] = {
      {kFramesPerS, "1/s"},     {kCharactersPerFlow, "characters"}, {"unreadable_barcodes", "frames"},
      {"stated_cost", "ratio"}, {kSeamContrast, "levels"},          {kSeamControl, "levels"}};
  static constexpr std::pair<const char*, const char*> kByWord[] = {
      {"db", "dB"},       {"bytes", "bytes"},     {"bps", "bit/s"},    {"s", "s"},
      {"seconds", "s"},   {"ms", "ms"},           {"mm", "mm"},        {"px", "px"},
      {"ratio", "ratio"}, {"percent", "percent"}, {"levels", "levels"}};
  for (const auto& [name, unit] : kByName)
    if (quantity == name) return unit;
  for (const auto& [word, unit] : kByWord)
    if (("_" + quantity + "_").find("_" + std::string(word) + "_") != std::string::npos) return unit;
  return "";
}

void RowWriter::add(std::initializer_list<std::pair<const char*, double>> values) const {
  for (const auto& [quantity, value] : values)
    out_->push_back({row_.table, row_.sequence, row_.method, row_.setting, quantity, value, rows::unitOf(quantity)});
}

void writeScores(const RowWriter& row, const measure::MeanScores& scores) {
  if (scores.count() == 0) return;
  const measure::PictureScore m = scores.mean();
  row.add({{kSsimFg, m.ssim_fg},
           {kSsimFull, m.ssim_full},
           {"ssim_box", m.ssim_box},
           {kPsnrFgDb, m.psnr_fg_db},
           {kPsnrFullDb, m.psnr_full_db},
           {"psnr_box_db", m.psnr_box_db},
           {kPsnrCommonDb, m.psnr_common_db}});
  if (!std::isnan(m.psnr_seen_db)) row.add({{kPsnrSeenDb, m.psnr_seen_db}, {kSsimSeen, m.ssim_seen}});
  if (scores.count() < 2) return;
  const measure::PictureScore error = scores.standardError();
  row.add({{kPsnrFgSeDb, error.psnr_fg_db}, {kSsimFgSe, error.ssim_fg}});
}

Result<Rows> parseRowsCsv(const std::string& text, const std::string& path) {
  const auto broken = [&](size_t line) {
    return Error{ErrorId::FileUnreadable, path + ": line " + std::to_string(line) + " is no row of a study (" +
                                              kHeader + "); delete the file and run the study again"};
  };
  std::vector<std::vector<std::string>> records;
  if (!splitCsv(text, records)) return broken(records.size() + 1);
  if (records.empty() || records[0].size() != kFields || records[0][0] != "table") return broken(1);
  Rows out;
  for (size_t i = 1; i < records.size(); ++i) {
    auto& r = records[i];
    double value = 0;
    if (r.size() != kFields || !parseNumber(r[5], value)) return broken(i + 1);
    out.push_back({r[0], r[1], r[2], r[3], r[4], value, r[6]});
  }
  return out;
}

BytesAtQuality bytesAtQuality(std::vector<RatePoint> points, double quality) {
  if (points.empty() || !std::isfinite(quality)) return {};
  std::sort(points.begin(), points.end(), [](const RatePoint& a, const RatePoint& b) { return a.quality < b.quality; });
  if (quality > points.back().quality) return {std::nullopt, 1};
  if (quality < points.front().quality) return {std::nullopt, -1};
  size_t i = 0;
  while (points[i].quality < quality) ++i;
  if (points[i].quality == quality) return {points[i].bytes, 0};
  const RatePoint &a = points[i - 1], &b = points[i];
  const double t = (quality - a.quality) / (b.quality - a.quality);
  return {std::exp(std::log(a.bytes) + t * (std::log(b.bytes) - std::log(a.bytes))), 0};
}

}  // namespace fourdvt::study
