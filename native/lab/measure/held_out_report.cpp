// SPDX-License-Identifier: Apache-2.0
// Report of an evaluation: table, CSV, contact sheet of the worst views.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "lab/measure/held_out.h"

namespace fourdvt::measure {
namespace {

std::string row(const std::string& name, const MeanViewScore& m, bool yardstick) {
  const auto& [psnr_db, ssim, common_db] = m.ours;
  std::string out = printed("  %-10s %6zu %9.2f %8.4f %10.2f", name.c_str(), m.views, psnr_db, ssim, common_db);
  if (yardstick)
    out += printed(" %11.2f %8.4f %10.2f", m.yardstick.psnr_db, m.yardstick.ssim, m.yardstick.common_psnr_db);
  return out + "\n";
}

std::vector<std::string> distinct(const std::vector<ViewScore>& scores, bool held_out, std::string ViewScore::*field) {
  std::vector<std::string> out;
  for (const ViewScore& s : scores)
    if (s.held_out == held_out && std::find(out.begin(), out.end(), s.*field) == out.end()) out.push_back(s.*field);
  return out;
}

std::string section(const HeldOutReport& report, bool held_out) {
  const auto sequences = distinct(report.scores, held_out, &ViewScore::sequence);
  if (sequences.empty()) return {};
  const bool yardstick = held_out && !std::isnan(meanViewScore(report.scores, true, "", "").yardstick.psnr_db);
  std::string out = held_out ? "Held-out cameras\n" : "Input cameras\n";
  for (const std::string& sequence : sequences) {
    out += sequence + "\n  camera      views   PSNR dB     SSIM  common dB" +
           (yardstick ? "  yardst. dB     SSIM  common dB\n" : "\n");
    for (const std::string& camera : distinct(report.scores, held_out, &ViewScore::camera))
      out += row(camera, meanViewScore(report.scores, held_out, sequence, camera), yardstick);
    out += row("mean", meanViewScore(report.scores, held_out, sequence, ""), yardstick);
  }
  if (sequences.size() > 1)
    out += "all sequences\n" + row("mean", meanViewScore(report.scores, held_out, "", ""), yardstick);
  return out;
}

// Bounding box of the content of all pictures, with a margin of 16 pixels.
cv::Rect shownPart(const WorstView& view) {
  int left = view.truth.width, top = view.truth.height, right = 0, bottom = 0;
  for (const Image* image : {&view.truth, &view.character}) {
    for (int y = 0; y < image->height; ++y)
      for (int x = 0; x < image->width; ++x) {
        const uint8_t* p = image->at(x, y);
        if (p[0] + p[1] + p[2] < 24) continue;
        left = std::min(left, x), right = std::max(right, x + 1), top = std::min(top, y),
        bottom = std::max(bottom, y + 1);
      }
  }
  if (right <= left) return {0, 0, view.truth.width, view.truth.height};
  const cv::Rect grown(left - 16, top - 16, right - left + 32, bottom - top + 32);
  return grown & cv::Rect(0, 0, view.truth.width, view.truth.height);
}

cv::Mat wrapped(const Image& image) {
  return {image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.pixels.data())};
}

cv::Mat titled(const cv::Mat& picture, const std::string& title) {
  constexpr int kBar = 26;
  cv::Mat out(picture.rows + kBar, picture.cols + 4, CV_8UC3, cv::Scalar(32, 32, 32));
  picture.copyTo(out(cv::Rect(0, kBar, picture.cols, picture.rows)));
  cv::putText(out, title, {6, 18}, cv::FONT_HERSHEY_SIMPLEX, 0.45, {230, 230, 230}, 1, cv::LINE_AA);
  return out;
}

cv::Mat sheetRow(const WorstView& view, const std::string& baseline) {
  const cv::Rect part = shownPart(view);
  const std::string scores = printed("ours %.2f dB / %.3f", view.score.ours.psnr_db, view.score.ours.ssim);
  cv::Mat difference;
  cv::absdiff(wrapped(view.truth), wrapped(view.character), difference);
  difference *= 4;
  std::vector<cv::Mat> columns{titled(wrapped(view.truth)(part), view.score.sequence + " " + view.score.camera +
                                                                     " frame " + std::to_string(view.score.frame)),
                               titled(wrapped(view.character)(part), scores)};
  if (!view.yardstick.empty()) {
    const std::string theirs = printed(" %.2f dB / %.3f", view.score.yardstick.psnr_db, view.score.yardstick.ssim);
    columns.push_back(titled(wrapped(view.yardstick)(part), baseline + theirs));
  }
  columns.push_back(titled(difference(part), "|truth - ours| x 4"));
  cv::Mat out;
  cv::hconcat(columns, out);
  return out;
}

std::string flickerSection(const std::vector<FlickerScore>& scores) {
  if (scores.empty()) return {};
  std::string out = "Flicker: mean change between consecutive pictures\nsequence     camera      pairs   levels\n";
  std::string sequence, camera;
  for (const FlickerScore& s : scores) {
    if (s.sequence == sequence && s.camera == camera) continue;
    sequence = s.sequence, camera = s.camera;
    const auto pairs = std::count_if(scores.begin(), scores.end(), [&](const FlickerScore& other) {
      return other.sequence == sequence && other.camera == camera && !std::isnan(other.levels);
    });
    out += printed("%-12s %-10s %6d %8.3f\n", sequence.c_str(), camera.c_str(), int(pairs),
                   meanFlicker(scores, sequence, camera));
  }
  return out;
}

}  // namespace

double meanFlicker(const std::vector<FlickerScore>& scores, const std::string& sequence, const std::string& camera) {
  double sum = 0;
  size_t count = 0;
  for (const FlickerScore& s : scores)
    if (s.sequence == sequence && s.camera == camera && !std::isnan(s.levels)) sum += s.levels, ++count;
  return count ? sum / double(count) : kNotAsked;
}

MeanViewScore meanViewScore(const std::vector<ViewScore>& scores, bool held_out, const std::string& sequence,
                            const std::string& camera) {
  std::vector<const ViewScore*> meant;
  for (const ViewScore& s : scores)
    if (s.held_out == held_out && (sequence.empty() || s.sequence == sequence) &&
        (camera.empty() || s.camera == camera))
      meant.push_back(&s);
  const auto mean = [&](ViewQuality ViewScore::*whose) {
    ViewQuality out{0, 0, 0};
    for (const auto field : {&ViewQuality::psnr_db, &ViewQuality::ssim, &ViewQuality::common_psnr_db}) {
      for (const ViewScore* s : meant) out.*field += s->*whose.*field;
      out.*field /= double(meant.size());
    }
    return out;
  };
  return {meant.size(), mean(&ViewScore::ours), mean(&ViewScore::yardstick)};
}

std::string scoreTable(const HeldOutReport& report) {
  std::string out = section(report, true) + section(report, false) + flickerSection(report.flicker);
  for (const WorstView& worst : report.worst) {
    out += printed("worst of %s: %s frame %u, %.2f dB / %.4f\n", worst.score.sequence.c_str(),
                   worst.score.camera.c_str(), worst.score.frame, worst.score.ours.psnr_db, worst.score.ours.ssim);
  }
  return out;
}

std::string scoreCsv(const HeldOutReport& report) {
  std::string out =
      "kind,sequence,camera,frame,psnr_db,ssim,common_psnr_db,yardstick_psnr_db,yardstick_ssim,yardstick_common_psnr_"
      "db,flicker_levels\n";
  for (const ViewScore& s : report.scores) {
    out += printed("%s,%s,%s,%u,%.4f,%.6f,%.4f,", s.held_out ? "held-out" : "input", s.sequence.c_str(),
                   s.camera.c_str(), s.frame, s.ours.psnr_db, s.ours.ssim, s.ours.common_psnr_db);
    out += std::isnan(s.yardstick.psnr_db)
               ? ",,"
               : printed("%.4f,%.6f,%.4f", s.yardstick.psnr_db, s.yardstick.ssim, s.yardstick.common_psnr_db);
    out += ",\n";
  }
  for (const FlickerScore& s : report.flicker) {
    if (!std::isnan(s.levels))
      out += printed("flicker,%s,%s,%u,,,,,,,%.4f\n", s.sequence.c_str(), s.camera.c_str(), s.frame, s.levels);
  }
  return out;
}

Image contactSheet(const std::vector<WorstView>& worst, const std::string& baseline) {
  std::vector<cv::Mat> rows;
  int width = 1, height = 0;
  for (const WorstView& view : worst) {
    rows.push_back(sheetRow(view, baseline));
    width = std::max(width, rows.back().cols);
    height += rows.back().rows;
  }
  Image out(width, std::max(height, 1), 3, 32);
  cv::Mat sheet = wrapped(out);
  int y = 0;
  for (const cv::Mat& row_picture : rows) {
    row_picture.copyTo(sheet(cv::Rect(0, y, row_picture.cols, row_picture.rows)));
    y += row_picture.rows;
  }
  return out;
}

}  // namespace fourdvt::measure
