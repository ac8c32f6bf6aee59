// SPDX-License-Identifier: Apache-2.0
// Rows as text, writers of rows, and bytes at matched quality. Needs neither GPU nor files.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lab/study/run/context.h"
#include "measure/picture_score.h"

namespace fourdvt::study {

std::string rowsCsv(const Rows& rows);
// Text of evaluate.json: settings of the run and the rows, {"generator", "capture", "quick", "sequences", "jobs",
// "rows": [{"table", "sequence", "method", "setting", "quantity", "value", "unit"}, …]}. A non-finite value is null;
// "text=…" settings of table "about" are unchanged.
std::string rowsJson(const Rows& rows, const StudyOptions& options, const std::string& capture_name);
Result<Rows> parseRowsCsv(const std::string& text, const std::string& path);

// Appends rows with common table, sequence, method and setting; the unit follows from the quantity.
class RowWriter {
 public:
  RowWriter(Rows& out, std::string table, std::string sequence, std::string method, std::string setting)
      : out_(&out), row_{std::move(table), std::move(sequence), std::move(method), std::move(setting), {}, 0, {}} {}
  void add(std::initializer_list<std::pair<const char*, double>> values) const;

 private:
  Rows* out_;
  Row row_;
};

// Writes rows ssim_fg, ssim_full, ssim_box, psnr_fg_db, psnr_full_db, psnr_box_db, psnr_common_db, none without scores;
// from two scores on also the standard errors of the means psnr_fg_db and ssim_fg.
void writeScores(const RowWriter& row, const measure::MeanScores& scores);

struct RatePoint {
  double bytes = 0, quality = 0;  // dB or SSIM: larger is better
};
// Bytes at a quality, by linear interpolation of log bytes between points of neighbouring quality. No extrapolation:
// bytes is empty outside the points' range, and `beyond` is the side. Points in any order.
struct BytesAtQuality {
  std::optional<double> bytes;
  int beyond = 0;  // 1: better than all points, -1: worse than all points, 0: within the range, or unknown
};
BytesAtQuality bytesAtQuality(std::vector<RatePoint> points, double quality);

}  // namespace fourdvt::study
