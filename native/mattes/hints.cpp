// SPDX-License-Identifier: Apache-2.0
#include "mattes/hints.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "base/text.h"
#include "capture/pictures.h"
#include "mattes/reduced.h"

namespace fourdvt::mattes {
namespace {

namespace fs = std::filesystem;

constexpr int kWhite = 250, kBlack = 5, kOpaque = 128;
constexpr int kSpacing = 4;              // pixels between tracked points of a stroke
constexpr int kRadius = 3;               // pixels around a tracked point that take its label
constexpr float kTravelled = 14;         // nats: less than strong evidence in the picture
constexpr float kMaxReturnError = 0.7f;  // pixels, after tracking there and back
constexpr float kMaxChange = 12;         // maximum change of a patch between two frames, levels, mean absolute
constexpr int kPatch = 15;

cv::Mat strokesOf(const Image& rgba) {
  cv::Mat out(rgba.height, rgba.width, CV_8U, cv::Scalar(0));
  for (int i = 0; i < int(out.total()); ++i) {
    const uint8_t* p = &rgba.pixels[4 * size_t(i)];
    if (p[3] < kOpaque) continue;
    if (std::min({p[0], p[1], p[2]}) >= kWhite) out.at<uint8_t>(i) = kObjectStroke;
    if (std::max({p[0], p[1], p[2]}) <= kBlack) out.at<uint8_t>(i) = kBackgroundStroke;
  }
  return out;
}

Status readCamera(const fs::path& folder, const capture::CaptureCamera& camera,
                  const capture::CaptureSequence& sequence, std::map<uint32_t, cv::Mat>& out) {
  std::map<uint32_t, uint32_t> frame_of;  // picture's number → frame
  for (uint32_t frame = 0; frame < sequence.frame_count; ++frame)
    frame_of[sequence.pictureOf(camera.pinhole.name, frame)] = frame;
  for (const fs::path& file : capture::sortedEntries(folder)) {
    const std::string number = file.stem().string();
    const bool is_number = !number.empty() && number.size() < 9 &&
                           std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (file.extension() != ".png" || !is_number || std::stoul(number) > frame_of.rbegin()->first) {
      const std::string last = printed("%06u.png", frame_of.rbegin()->first);
      return Error{ErrorId::InvalidArgument, file.string() +
                                                 ": hints are PNG files named after their picture, 000000.png to " +
                                                 last + "; rename it, or take it out"};
    }
    FOURDVT_ASSIGN(const auto picture, capture::readPicture(file.string(), 4));
    FOURDVT_TRY(capture::checkSize(picture, camera, file.string()));
    const auto frame = frame_of.find(uint32_t(std::stoul(number)));
    if (frame != frame_of.end()) out[frame->second] = strokesOf(picture);
  }
  return {};
}

}  // namespace

Result<Strokes> readStrokes(const capture::Capture& capture, const capture::CaptureSequence& sequence) {
  const fs::path all = fs::path(capture.folder) / capture::kHintsFolder;
  Strokes out(capture.cameras.size());
  FOURDVT_ASSIGN(const auto calibrated, capture::readColmapCameras(capture.cameras_folder));
  const auto isCamera = [&](const std::string& name) {
    return std::any_of(calibrated.begin(), calibrated.end(), [&](const auto& c) { return c.pinhole.name == name; });
  };
  std::error_code failed;
  const bool by_sequence = fs::is_directory(all / sequence.name, failed) && !isCamera(sequence.name);
  for (const fs::path& entry : capture::sortedEntries(by_sequence ? all / sequence.name : all)) {
    const std::string name = entry.filename().string();
    if (!isCamera(name)) {
      // Hints of another sequence, perhaps of one that is not selected.
      if (!by_sequence && fs::is_directory(fs::path(capture.folder) / name, failed)) continue;
      return Error{ErrorId::InvalidArgument,
                   entry.string() + ": no camera has this name; hints lie in folders named after cameras"};
    }
    if (!by_sequence && capture.sequences.size() > 1)
      return Error{ErrorId::InvalidArgument,
                   entry.string() + ": the capture has several sequences; move these hints to " +
                       (all / sequence.name / name).string() + " or another sequence's folder"};
    const auto at = std::find_if(capture.cameras.begin(), capture.cameras.end(),
                                 [&](const auto& c) { return c.pinhole.name == name; });
    if (at != capture.cameras.end())
      FOURDVT_TRY(readCamera(entry, *at, sequence, out[size_t(at - capture.cameras.begin())]));
  }
  return out;
}

void HintTrack::advance(const Image& picture, const cv::Mat* strokes) {
  cv::Mat now;
  cv::cvtColor(matrixOf(picture), now, cv::COLOR_RGB2GRAY);
  if (!points_.empty()) {
    std::vector<cv::Point2f> from, to, back;
    for (const Point& p : points_) from.push_back(p.at);
    std::vector<uint8_t> found, returned;
    std::vector<float> error, ignored;
    const cv::Size patch(kPatch, kPatch);
    cv::calcOpticalFlowPyrLK(grey_, now, from, to, found, error, patch);
    cv::calcOpticalFlowPyrLK(now, grey_, to, back, returned, ignored, patch);
    std::vector<Point> kept;
    for (size_t i = 0; i < from.size(); ++i)
      if (found[i] && returned[i] && error[i] <= kMaxChange && cv::norm(back[i] - from[i]) <= kMaxReturnError &&
          to[i].x >= 0 && to[i].y >= 0 && to[i].x < float(now.cols) && to[i].y < float(now.rows))
        kept.push_back({to[i], points_[i].object});
    points_ = std::move(kept);
  }
  grey_ = now;
  strokes_ = strokes ? *strokes : cv::Mat();
  if (!strokes) return;
  for (int y = 0; y < strokes->rows; y += kSpacing)
    for (int x = 0; x < strokes->cols; x += kSpacing) addPoint(*strokes, x, y);
}

// Stroke pixel nearest to the middle of a cell of kSpacing pixels, so that thin strokes are tracked, too.
void HintTrack::addPoint(const cv::Mat& strokes, int cell_x, int cell_y) {
  int nearest = kSpacing * kSpacing;
  Point point{};
  for (int y = cell_y; y < std::min(cell_y + kSpacing, strokes.rows); ++y)
    for (int x = cell_x; x < std::min(cell_x + kSpacing, strokes.cols); ++x) {
      const int dx = x - cell_x - kSpacing / 2, dy = y - cell_y - kSpacing / 2, away = dx * dx + dy * dy;
      const uint8_t stroke = strokes.at<uint8_t>(y, x);
      if (stroke != 0 && away < nearest) nearest = away, point = {{float(x), float(y)}, stroke == kObjectStroke};
    }
  if (nearest < kSpacing * kSpacing) points_.push_back(point);
}

cv::Mat HintTrack::cost() const {
  if (points_.empty() && strokes_.empty()) return {};
  cv::Mat out(grey_.size(), CV_32F, cv::Scalar(0));
  for (const Point& p : points_)
    cv::circle(out, p.at, kRadius, cv::Scalar(p.object ? -kTravelled : kTravelled), cv::FILLED);
  for (int i = 0; i < int(strokes_.total()); ++i)
    if (const uint8_t stroke = strokes_.at<uint8_t>(i)) out.at<float>(i) = stroke == kObjectStroke ? -kObeyed : kObeyed;
  return out;
}

}  // namespace fourdvt::mattes
