// SPDX-License-Identifier: Apache-2.0
// Rows as text, writers of rows, and bytes at matched quality. Needs neither GPU nor files.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/picture_score.h"
#include "lab/study/run/context.h"

namespace fourdvt::study {

std::string rowsCsv(const Rows& rows);
// evaluate.json: what was run and the same rows, {"generator", "capture", "quick", "sequences", "jobs",
// "rows": [{"table", "sequence", "method", "setting", "quantity", "value", "unit"}, …]}. A value that is not finite is
// null; "text=…" settings of table "about" stay as they are.
std::string rowsJson(const Rows& rows, const StudyOptions& options, const std::string& capture_name);
Result<Rows> parseRowsCsv(const std::string& text, const std::string& path);

// Appends rows with table, sequence, method and setting in common.
class RowWriter {
 public:
  RowWriter(Rows& out, std::string table, std::string sequence, std::string method, std::string setting)
      : out_(&out), row_{std::move(table), std::move(sequence), std::move(method), std::move(setting), {}, 0, {}} {}
  void add(const char* quantity, double value, const char* unit) const {
    Row row = row_;
    row.quantity = quantity;
    row.value = value;
    row.unit = unit;
    out_->push_back(std::move(row));
  }

 private:
  Rows* out_;
  Row row_;
};

// Rows ssim_fg, ssim_full, ssim_box, psnr_fg_db, psnr_full_db, psnr_box_db, psnr_common_db, none without scores; from
// two scores on also the standard errors of the means psnr_fg_db and ssim_fg.
void writeScores(const RowWriter& row, const measure::MeanScores& scores);

struct RatePoint {
  double bytes = 0, quality = 0;  // dB or SSIM: more is better
};
// Bytes at a quality: the logarithm of the bytes is linear between points of neighbouring quality. Nothing is
// extrapolated: bytes is empty outside of the range of the points, and `beyond` says on which side. Any order.
struct BytesAtQuality {
  std::optional<double> bytes;
  int beyond = 0;  // 1: better than every point, -1: worse than every point, 0: within the range, or unknown
};
BytesAtQuality bytesAtQuality(std::vector<RatePoint> points, double quality);

}  // namespace fourdvt::study
