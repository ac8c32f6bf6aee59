// SPDX-License-Identifier: Apache-2.0
#include "refine/silhouettes/silhouette_clip.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "mattes/frame_reader.h"

namespace fourdvt::refine {
namespace {

constexpr double kDistanceBytes = 300e6;  // all distances together
constexpr double kFigureShare = 0.4;      // share of a picture around the figure
constexpr int kBorderPixels = 2;          // outlines are unreliable this close to the picture's border

std::vector<glm::vec2> outlineOf(const Image& coverage) {
  cv::Mat inside(coverage.height, coverage.width, CV_8U);
  for (size_t i = 0; i < coverage.pixels.size(); ++i) inside.data[i] = coverage.pixels[i] > 127 ? 255 : 0;
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(inside, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  std::vector<glm::vec2> out;
  for (const auto& contour : contours)
    for (const cv::Point& p : contour)
      if (p.x >= kBorderPixels && p.y >= kBorderPixels && p.x < coverage.width - kBorderPixels &&
          p.y < coverage.height - kBorderPixels)
        out.emplace_back(float(p.x) + 0.5f, float(p.y) + 0.5f);
  return out;
}

int reductionOf(const capture::Capture& capture, uint32_t frames) {
  double bytes = 0;
  for (const auto& camera : capture.cameras)
    bytes += sizeof(float) * kFigureShare * camera.pinhole.width * camera.pinhole.height * frames;
  return std::max(1, int(std::ceil(std::sqrt(bytes / kDistanceBytes))));
}

Image coverageOf(const Image& rgba, const PinholeCamera& camera) {
  Image alpha(rgba.width, rgba.height, 1);
  for (size_t i = 0; i < alpha.pixels.size(); ++i) alpha.pixels[i] = rgba.pixels[4 * i + 3];
  if (camera.width == rgba.width && camera.height == rgba.height) return alpha;
  Image out(camera.width, camera.height, 1);
  const cv::Mat from(alpha.height, alpha.width, CV_8U, alpha.pixels.data());
  cv::Mat to(out.height, out.width, CV_8U, out.pixels.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return out;
}

}  // namespace

void SilhouetteClip::add(const std::vector<Image>& coverages) {
  std::vector<std::vector<glm::vec2>> outlines(coverages.size());
  std::vector<std::optional<silhouette::SilhouetteDistance>> made(coverages.size());
  inParallel(coverages.size(), [&](int c) {
    made[c].emplace(coverages[c]);
    outlines[c] = outlineOf(coverages[c]);
  });
  std::vector<silhouette::SilhouetteDistance> distances;
  for (auto& distance : made) distances.push_back(std::move(*distance));
  frames_.push_back(std::move(distances));
  outlines_.push_back(std::move(outlines));
}

std::vector<size_t> SilhouetteClip::spreadFrames(size_t most) const {
  std::vector<size_t> out;
  const size_t stride = std::max<size_t>(1, (frames_.size() + most - 1) / most);
  for (size_t f = 0; f < frames_.size(); f += stride) out.push_back(f);
  return out;
}

SilhouetteClip::Instant SilhouetteClip::instant(size_t camera, double frame) const {
  const auto count = double(frames_.size());
  if (loop_) frame -= count * std::floor(frame / count);
  if (!(frame >= 0) || (!loop_ && frame > count - 1)) return {};
  const auto first = std::min(size_t(frame), frames_.size() - 1);
  const size_t second = loop_ ? (first + 1) % frames_.size() : std::min(first + 1, frames_.size() - 1);
  Instant out{&frames_[first][camera], &frames_[second][camera], float(frame - double(first))};
  if (out.before->empty() || out.before->full() || out.after->empty() || out.after->full()) return {};
  return out;
}

std::optional<std::pair<glm::dvec2, glm::dvec2>> SilhouetteClip::boundsAt(size_t camera, double frame) const {
  if (!instant(camera, frame).before) return std::nullopt;
  const auto count = double(frames_.size());
  if (loop_) frame -= count * std::floor(frame / count);
  const std::vector<glm::vec2>& outline = outlines_[size_t(std::lround(frame)) % frames_.size()][camera];
  if (outline.empty()) return std::nullopt;
  glm::dvec2 low(1e9), high(-1e9);
  for (const glm::vec2& p : outline) low = glm::min(low, glm::dvec2(p)), high = glm::max(high, glm::dvec2(p));
  return std::pair{low, high};
}

std::vector<EdgePoint> SilhouetteClip::edge(size_t camera, size_t frame, size_t count) const {
  std::vector<EdgePoint> out;
  const std::vector<glm::vec2>& outline = outlines_[frame][camera];
  const Instant here = instant(camera, double(frame));
  if (!here.before || outline.empty()) return out;
  const Instant earlier = instant(camera, double(frame) - 1), later = instant(camera, double(frame) + 1);
  const size_t stride = std::max<size_t>(1, outline.size() / count);
  for (size_t i = 0; i < outline.size(); i += stride) {
    EdgePoint point;
    const glm::vec2 p = outline[i];
    const glm::vec2 inward(here.at(p.x + 1, p.y) - here.at(p.x - 1, p.y),
                           here.at(p.x, p.y + 1) - here.at(p.x, p.y - 1));
    if (!(glm::length(inward) > 1)) continue;  // thin part without a clear side
    point.outward = -glm::normalize(inward);
    point.pixel = p + here.at(p.x, p.y) * point.outward;
    const glm::vec2 q = point.pixel;
    if (earlier.before && later.before)
      point.pixels_per_frame = 0.5f * (later.at(q.x, q.y) - earlier.at(q.x, q.y));
    else if (earlier.before || later.before)
      point.pixels_per_frame = later.before ? later.at(q.x, q.y) : -earlier.at(q.x, q.y);
    out.push_back(point);
  }
  return out;
}

Result<SilhouetteClip> readSilhouetteClip(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                          const OpenVideo& open_video, uint32_t max_frames, size_t clips,
                                          const std::function<bool(double share)>& on_frame) {
  const uint32_t count = std::min(sequence.frame_count, max_frames);
  const int reduction = reductionOf(capture, max_frames * uint32_t(clips));
  std::vector<PinholeCamera> cameras;
  for (const auto& camera : capture.cameras) cameras.push_back(reducedCamera(camera.pinhole, reduction));
  const uint32_t first = (sequence.frame_count - count) / 2;
  SilhouetteClip clip(cameras, sequence.loop && !sequence.travel && count == sequence.frame_count);
  clip.first_frame = first;
  FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(capture, sequence, open_video, first));
  for (uint32_t f = 0; f < count; ++f) {
    if (!on_frame(double(f) / count))
      return Error{ErrorId::Interrupted, "stopped; nothing was saved, run the same command again"};
    FOURDVT_ASSIGN(const auto captured, reader->next());
    std::vector<Image> coverages;
    for (size_t c = 0; c < cameras.size(); ++c) coverages.push_back(coverageOf(captured.pictures[c], cameras[c]));
    clip.add(coverages);
  }
  return clip;
}

}  // namespace fourdvt::refine
