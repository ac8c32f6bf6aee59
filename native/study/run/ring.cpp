// SPDX-License-Identifier: Apache-2.0
#include "study/run/ring.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "measure/metrics.h"
#include "study/run/row_writer.h"
#include "study/run/rows.h"

namespace fourdvt::study {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846, kMargin = 1.08, kEqual_db = 100;

double turned(double degrees) {
  const double rest = std::fmod(degrees, 360.0);
  return rest < 0 ? rest + 360 : rest;
}

struct RigPoint {
  double azimuth_deg, elevation_deg, distance_m;
};

std::vector<RigPoint> rigPoints(std::span<const PinholeCamera> cameras, const glm::dvec3& target) {
  std::vector<RigPoint> points;
  for (const PinholeCamera& camera : cameras) {
    const glm::dvec3 d = camera.centreInWorld() - target;
    const double length = glm::length(d);
    points.push_back({turned(std::atan2(d.x, d.z) * kDegrees), std::asin(d.y / length) * kDegrees, length});
  }
  std::sort(points.begin(), points.end(),
            [](const RigPoint& a, const RigPoint& b) { return a.azimuth_deg < b.azimuth_deg; });
  return points;
}

// Linear in azimuth between the two neighbouring cameras.
RigPoint rigAt(const std::vector<RigPoint>& rig, double azimuth_deg) {
  for (size_t i = 0; i < rig.size(); ++i) {
    const RigPoint &a = rig[i], &b = rig[(i + 1) % rig.size()];
    const double gap = rig.size() == 1 ? 360 : turned(b.azimuth_deg - a.azimuth_deg);
    const double along = turned(azimuth_deg - a.azimuth_deg);
    if (along > gap) continue;
    const double t = gap > 0 ? along / gap : 0;
    return {azimuth_deg, a.elevation_deg + t * (b.elevation_deg - a.elevation_deg),
            a.distance_m + t * (b.distance_m - a.distance_m)};
  }
  return rig[0];
}

int rounded16(double pixels, int largest) {
  const int up = static_cast<int>(std::ceil(pixels / 16)) * 16;
  return std::min(up, largest / 2 * 2);
}

// Side lengths of the picture that holds the box from everywhere, pixels.
glm::ivec2 pictureSize(std::span<const PinholeCamera> cameras, const BoundingBox& bounds,
                       const std::vector<RigPoint>& rig, double focal) {
  const glm::dvec3 half = 0.5 * glm::dvec3(bounds.max - bounds.min);
  const double radius = std::hypot(half.x, half.z);
  double nearest = std::numeric_limits<double>::infinity(), steepest = 0;
  for (const RigPoint& p : rig) {
    nearest = std::min(nearest, p.distance_m);
    steepest = std::max(steepest, std::abs(p.elevation_deg) / kDegrees);
  }
  const double depth = std::max(nearest - radius, 0.1 * nearest);
  const double upright = half.y * std::cos(steepest) + radius * std::sin(steepest);
  return {rounded16(kMargin * 2 * radius * focal / depth, cameras[0].width),
          rounded16(kMargin * 2 * upright * focal / depth, cameras[0].height)};
}

double capped(double psnr_db) { return std::isinf(psnr_db) ? kEqual_db : psnr_db; }

struct Box {
  int x0, y0, x1, y1;
};

Box boundingBox(const measure::Mask& mask, int width, int height) {
  Box box{width, height, 0, 0};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!mask[static_cast<size_t>(y) * width + x]) continue;
      box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1), std::max(box.y1, y + 1)};
    }
  return box;
}

Image cropped(const Image& image, const Box& box) {
  Image out(box.x1 - box.x0, box.y1 - box.y0, image.channels);
  for (int y = 0; y < out.height; ++y)
    std::copy_n(image.at(box.x0, box.y0 + y), static_cast<size_t>(out.width) * out.channels, out.at(0, y));
  return out;
}

// Everything that is not black in either picture, with the reach of SSIM's window to each side.
Box contentBox(const Image& a, const Image& b) {
  measure::Mask mask(static_cast<size_t>(a.width) * a.height);
  for (size_t i = 0; i < mask.size(); ++i)
    for (int c = 0; c < 3; ++c) mask[i] |= a.pixels[3 * i + c] | b.pixels[3 * i + c];
  Box box = boundingBox(mask, a.width, a.height);
  if (box.x0 >= box.x1) return {0, 0, a.width, a.height};
  const int reach = measure::kSsimWindow;
  return {std::max(0, box.x0 - reach), std::max(0, box.y0 - reach), std::min(a.width, box.x1 + reach),
          std::min(a.height, box.y1 + reach)};
}

}  // namespace

std::vector<double> ringAzimuths_deg(std::vector<double> cameras, int count) {
  for (double& a : cameras) a = turned(a);
  std::sort(cameras.begin(), cameras.end());
  std::vector<double> special;  // camera, middle, camera, …
  for (size_t i = 0; i < cameras.size(); ++i) {
    const double gap = i + 1 < cameras.size() ? cameras[i + 1] - cameras[i] : cameras[0] + 360 - cameras[i];
    special.push_back(cameras[i]);
    special.push_back(turned(cameras[i] + gap / 2));
  }
  std::vector<double> out;
  const int known = static_cast<int>(special.size());
  if (count <= known) {
    for (int i = 0; i < count; ++i) {
      const int even = 2 * static_cast<int>(std::lround(double(i) * known / count / 2));
      out.push_back(special[(even + (i & 1)) % known]);
    }
  } else {
    std::vector<bool> taken(count, false);
    for (int i = 0; i < count; ++i) out.push_back(turned(special[0] + 360.0 * i / count));
    for (double direction : special) {
      const int nearest = static_cast<int>(std::lround(turned(direction - special[0]) * count / 360)) % count;
      if (taken[nearest]) continue;
      taken[nearest] = true;
      out[nearest] = direction;
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<RingView> ringViews(std::span<const PinholeCamera> cameras, const BoundingBox& bounds, uint32_t frame_count,
                                int count) {
  const glm::dvec3 target = 0.5 * (glm::dvec3(bounds.min) + glm::dvec3(bounds.max));
  const std::vector<RigPoint> rig = rigPoints(cameras, target);
  double focal = 0;
  for (const PinholeCamera& camera : cameras) focal += 0.5 * (camera.fx + camera.fy) / cameras.size();
  const glm::ivec2 size = pictureSize(cameras, bounds, rig, focal);
  std::vector<double> azimuths;
  for (const RigPoint& p : rig) azimuths.push_back(p.azimuth_deg);
  azimuths = ringAzimuths_deg(azimuths, count);
  std::vector<RingView> views;
  for (int i = 0; i < count; ++i) {
    const RigPoint p = rigAt(rig, azimuths[i]);
    RingView view;
    view.camera = cameraFromOrbit(
        {p.azimuth_deg, p.elevation_deg, p.distance_m, target, 2 * std::atan(0.5 * size.y / focal) * kDegrees}, size.x,
        size.y);
    char name[24];
    std::snprintf(name, sizeof name, "az%05.1f", p.azimuth_deg);
    view.camera.name = name;
    view.frame = static_cast<uint32_t>(static_cast<uint64_t>(i) * frame_count / count);
    views.push_back(std::move(view));
  }
  return views;
}

PictureScore scorePicture(const Image& reference, const Image& picture) {
  const measure::Mask fg = measure::unionOfSilhouettes(reference, picture);
  const Image a = measure::compositedOnBlack(reference), b = measure::compositedOnBlack(picture);
  const int w = a.width, h = a.height;
  PictureScore out;
  out.psnr_full_db = capped(measure::psnr(a, b, measure::Mask(fg.size(), 1)));
  out.psnr_fg_db = capped(measure::psnr(a, b, fg));
  out.psnr_common_db = capped(measure::psnr(a, b, measure::commonSilhouette(reference, picture)));
  const Box box = boundingBox(fg, w, h), content = contentBox(a, b);
  measure::Mask in_box(fg.size(), 0);
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) in_box[static_cast<size_t>(y) * w + x] = 1;
  out.psnr_box_db = capped(measure::psnr(a, b, in_box));
  const std::vector<double> map = measure::ssimMap(cropped(a, content), cropped(b, content));
  double full = 0, boxed = 0, inside = 0;
  size_t full_count = 0, boxed_count = 0, inside_count = 0;
  const int reach = measure::kSsimWindow / 2;
  for (int y = reach; y < h - reach; ++y)
    for (int x = reach; x < w - reach; ++x) {
      const size_t i = static_cast<size_t>(y) * w + x;
      const bool mapped =
          x >= content.x0 + reach && x < content.x1 - reach && y >= content.y0 + reach && y < content.y1 - reach;
      const double value =
          mapped ? map[static_cast<size_t>(y - content.y0) * (content.x1 - content.x0) + x - content.x0] : 1;
      full += value, ++full_count;
      if (in_box[i]) boxed += value, ++boxed_count;
      if (fg[i]) inside += value, ++inside_count;
    }
  out.ssim_full = full / static_cast<double>(full_count);
  out.ssim_box = boxed / static_cast<double>(boxed_count);
  out.ssim_fg = inside / static_cast<double>(inside_count);
  return out;
}

void MeanScores::add(const PictureScore& s) {
  sum_.psnr_full_db += s.psnr_full_db;
  sum_.psnr_box_db += s.psnr_box_db;
  sum_.psnr_fg_db += s.psnr_fg_db;
  sum_.psnr_common_db += s.psnr_common_db;
  sum_.ssim_full += s.ssim_full;
  sum_.ssim_box += s.ssim_box;
  sum_.ssim_fg += s.ssim_fg;
  ++count_;
}

PictureScore MeanScores::mean() const {
  const double n = static_cast<double>(count_);
  return {sum_.psnr_full_db / n, sum_.psnr_box_db / n, sum_.psnr_fg_db / n, sum_.psnr_common_db / n,
          sum_.ssim_full / n,    sum_.ssim_box / n,    sum_.ssim_fg / n};
}

void MeanScores::write(Rows& out, const std::string& table, const std::string& sequence, const std::string& method,
                       const std::string& setting) const {
  if (count_ == 0) return;
  const RowWriter row(out, table, sequence, method, setting);
  const PictureScore m = mean();
  row.add(rows::kSsimFg, m.ssim_fg, "");
  row.add(rows::kSsimFull, m.ssim_full, "");
  row.add("ssim_box", m.ssim_box, "");
  row.add(rows::kPsnrFgDb, m.psnr_fg_db, "dB");
  row.add(rows::kPsnrFullDb, m.psnr_full_db, "dB");
  row.add("psnr_box_db", m.psnr_box_db, "dB");
  row.add(rows::kPsnrCommonDb, m.psnr_common_db, "dB");
}

void ScoreLane::collect(size_t keep) {
  while (running_.size() > keep) {
    finished_.emplace_back(running_.front().first, running_.front().second.get());
    running_.pop_front();
  }
}

void ScoreLane::add(Image reference, Image picture, const std::string& tag) {
  collect(kWaiting - 1);
  running_.emplace_back(tag, std::async(std::launch::async, [a = std::move(reference), b = std::move(picture)] {
                          return scorePicture(a, b);
                        }));
}

std::vector<std::pair<std::string, PictureScore>> ScoreLane::finish() {
  collect(0);
  return std::move(finished_);
}

MeanScores ScoreLane::finishMean() {
  MeanScores mean;
  for (const auto& [tag, score] : finish()) mean.add(score);
  return mean;
}

}  // namespace fourdvt::study
