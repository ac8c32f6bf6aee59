// SPDX-License-Identifier: Apache-2.0
// Sources: Aldo Laurentini, "The Visual Hull Concept for Silhouette-Based Image Understanding", IEEE Transactions on
// Pattern Analysis and Machine Intelligence 16(2), 1994.
#include "mattes/support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"

namespace fourdvt::mattes {
namespace {

constexpr double kNearest = 0.05, kFarthest = 5;  // multiples of the distance to where the cameras look
constexpr int kProbes = 160;                      // depths at which a camera's depth range is searched
constexpr double kPixelsPerStep = 2;              // step along the epipolar line in the other camera
constexpr size_t kMaxDepths = 1024;
constexpr int kMinStep = 3, kMaxRays = 30'000;
constexpr int kCoarse = 4;  // grid places per step of the coarse search, which selects places for the fine one
constexpr int kReach = 12;  // pixels around a camera's own mask in which support is always searched
constexpr float kNone = -std::numeric_limits<float>::infinity();
constexpr int kShadow = 122, kShadowSpread = 40;  // shares of 128: darker than the plates, by about the same in all
                                                  // cameras
constexpr int kBlamed = 400;                      // pixels per mask that explain() judges

// Point closest to all optical axes.
glm::dvec3 middleOf(const std::vector<capture::CaptureCamera>& cameras) {
  glm::dmat3 a(0);
  glm::dvec3 b(0);
  for (const capture::CaptureCamera& c : cameras) {
    const glm::dvec3 axis = c.pinhole.forwardInWorld();
    const glm::dmat3 across = glm::dmat3(1) - glm::outerProduct(axis, axis) * 0.999;
    a += across;
    b += across * c.pinhole.centreInWorld();
  }
  return glm::inverse(a) * b;
}

cv::Mat asMat(const Image& picture) {
  return cv::Mat(picture.height, picture.width, CV_8U, const_cast<uint8_t*>(picture.pixels.data())).clone();
}

cv::Mat grown(const cv::Mat& mask, double radius) {
  cv::Mat out;
  const int r = std::max(0, int(std::ceil(radius)));
  cv::dilate(mask, out, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1}));
  return out;
}

}  // namespace

struct SupportFinder::Rays {
  PinholeCamera camera;
  capture::Undistorter undistorter;
  cv::Mat captured;  // CV_8U in the pinhole's pixels: 255 where the lens captured something
  int step = kMinStep;
  cv::Size grid;
  std::vector<glm::dvec3> through;  // world directions with depth 1 along the optical axis, one per grid place
  std::vector<double> depths_m;     // near to far, with steps of about two pixels in the other cameras

  bool sees(const glm::dvec3& in_camera, int& x, int& y) const {
    if (!(in_camera.z > 0)) return false;
    const double u = camera.fx * in_camera.x / in_camera.z + camera.cx;
    const double v = camera.fy * in_camera.y / in_camera.z + camera.cy;
    if (!(u >= 0 && v >= 0 && u < camera.width && v < camera.height)) return false;
    x = int(u), y = int(v);
    return captured.at<uint8_t>(y, x) >= 128;
  }
};

// Search along the rays of one camera by the other cameras.
struct SupportFinder::Search {
  const Rays* own = nullptr;
  std::vector<size_t> others;
  std::vector<const Rays*> rays;
  std::vector<cv::Mat> masks;
  std::vector<glm::dvec3> from;  // the camera's centre in the others' frames
  glm::dvec3 centre{0};
  size_t needed = 1;  // number of cameras that must see a place

  // Calls visit(depth, missed) for the places along a ray that enough of the others see; `missed`: indices into
  // `others`, at most `most` + 1 of them. visit returns false to stop.
  template <class Visit>
  void along(const glm::dvec3& through, size_t most, Visit visit) const {
    std::vector<glm::dvec3> direction(others.size());
    for (size_t k = 0; k < others.size(); ++k) direction[k] = glm::dmat3(rays[k]->camera.cam_from_world) * through;
    std::vector<size_t> missed;
    for (const double depth : own->depths_m) {
      size_t seen = 0;
      missed.clear();
      int x, y;
      for (size_t k = 0; k < others.size() && !(missed.size() > most && seen >= needed); ++k) {
        if (!rays[k]->sees(from[k] + depth * direction[k], x, y)) continue;
        ++seen;
        if (masks[k].at<uint8_t>(y, x) < 128) missed.push_back(k);
      }
      if (seen >= needed && !visit(depth, missed)) return;
    }
  }
};

SupportFinder::SupportFinder(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m)
    : ground_y_m_(ground_y_m) {
  const glm::dvec3 middle = middleOf(cameras);
  for (const capture::CaptureCamera& c : cameras) {
    Rays r{c.pinhole, capture::Undistorter(c), {}, kMinStep, {}, {}, {}};
    r.captured = asMat(r.undistorter.apply(Image(c.pinhole.width, c.pinhole.height, 1, 255)));
    r.step = std::max(kMinStep, int(std::ceil(std::sqrt(double(c.pinhole.width) * c.pinhole.height / kMaxRays))));
    r.grid = {(c.pinhole.width + r.step - 1) / r.step, (c.pinhole.height + r.step - 1) / r.step};
    const glm::dmat3 world_from_cam = glm::transpose(glm::dmat3(c.pinhole.cam_from_world));
    for (int y = 0; y < r.grid.height; ++y)
      for (int x = 0; x < r.grid.width; ++x) {
        const glm::dvec2 p = capture::pinholePixel(c, (glm::dvec2(x, y) + 0.5) * double(r.step));
        r.through.push_back(world_from_cam *
                            glm::dvec3((p.x - c.pinhole.cx) / c.pinhole.fx, (p.y - c.pinhole.cy) / c.pinhole.fy, 1));
      }
    rays_.push_back(std::move(r));
  }
  for (Rays& r : rays_) {
    // Depth range that enough of the others see, with steps as fine as the widest baseline needs.
    const double distance_m = glm::distance(r.camera.centreInWorld(), middle);
    footprint_m_ += distance_m / r.camera.fx / double(rays_.size());
    std::vector<double> inverse;
    for (int i = 0; i < kProbes; ++i)
      inverse.push_back(1 / (kNearest * distance_m) * std::pow(kNearest / kFarthest, double(i) / (kProbes - 1)));
    int first = kProbes, last = -1;
    for (size_t at = 0; at < r.through.size(); at += std::max<size_t>(1, r.through.size() / 300))
      for (int i = 0; i < kProbes; ++i) {
        size_t seen = 0;
        int x, y;
        for (const Rays& other : rays_)
          seen += &other != &r &&
                  other.sees(glm::dvec3(other.camera.cam_from_world *
                                        glm::dvec4(r.camera.centreInWorld() + r.through[at] / inverse[size_t(i)], 1)),
                             x, y);
        if (2 * seen >= rays_.size() - 1) first = std::min(first, i), last = std::max(last, i);
      }
    if (last < 0) continue;
    const double nearest = inverse[size_t(std::max(0, first - 1))];
    const double farthest = inverse[size_t(std::min(kProbes - 1, last + 1))];
    double disparity = 1;
    for (const Rays& other : rays_)
      disparity = std::max(disparity, other.camera.fx * (nearest - farthest) *
                                          glm::distance(other.camera.centreInWorld(), r.camera.centreInWorld()));
    const size_t count = std::clamp(size_t(disparity / kPixelsPerStep), size_t(64), kMaxDepths);
    for (size_t i = 0; i < count; ++i)
      r.depths_m.push_back(1 / (nearest + (farthest - nearest) * double(i) / double(count - 1)));
  }
}
SupportFinder::~SupportFinder() = default;

int SupportFinder::stepOf(size_t camera) const { return rays_[camera].step; }

cv::Mat SupportFinder::fullSize(const cv::Mat& grid, size_t camera) const {
  const Rays& r = rays_[camera];
  cv::Mat out;
  cv::resize(grid, out, {grid.cols * r.step, grid.rows * r.step}, 0, 0, cv::INTER_NEAREST);
  return out({0, 0, r.camera.width, r.camera.height}).clone();
}

cv::Mat SupportFinder::asPinhole(size_t camera, const cv::Mat& filmed) const {
  Image picture(filmed.cols, filmed.rows, 1);
  std::copy(filmed.begin<uint8_t>(), filmed.end<uint8_t>(), picture.pixels.begin());
  return asMat(rays_[camera].undistorter.apply(std::move(picture)));
}

std::vector<cv::Mat> SupportFinder::pinholeMasks(const std::vector<cv::Mat>& masks, double slack_pixels) const {
  std::vector<cv::Mat> out(masks.size());
  inParallel(masks.size(), [&](size_t i) {
    if (cv::countNonZero(masks[i]) > 0) out[i] = asPinhole(i, grown(masks[i], slack_pixels));
  });
  return out;
}

bool SupportFinder::shadowAt(size_t camera, int at, const std::vector<cv::Mat>& masks,
                             const std::vector<cv::Mat>& darkness) const {
  const Rays& own = rays_[camera];
  const glm::dvec3 centre = own.camera.centreInWorld(), through = own.through[size_t(at)];
  const double depth = (ground_y_m_ - centre.y) / through.y;
  if (!(depth > 0)) return false;
  const glm::dvec4 place(centre + depth * through, 1);
  std::vector<int> dark;
  int own_dark = 0, x, y;
  for (size_t j = 0; j < rays_.size(); ++j) {
    if (masks[j].empty() || !rays_[j].sees(glm::dvec3(rays_[j].camera.cam_from_world * place), x, y)) continue;
    if (masks[j].at<uint8_t>(y, x) < 128) return false;
    const int value = darkness[j].empty() ? 0 : darkness[j].at<uint8_t>(y, x);
    if (j == camera)
      own_dark = value;
    else if (value > 0)
      dark.push_back(value);
  }
  if (own_dark == 0 || own_dark > kShadow) return false;
  // At the patch's rim, and behind occluders, a camera may see another ratio.
  const auto alike = size_t(
      std::count_if(dark.begin(), dark.end(), [&](int value) { return std::abs(value - own_dark) <= kShadowSpread; }));
  return alike >= 2 && 2 * alike >= dark.size();
}

std::vector<cv::Mat> SupportFinder::shadows(const std::vector<cv::Mat>& masks, const std::vector<cv::Mat>& darkness,
                                            double slack_pixels) const {
  const std::vector<cv::Mat> pinhole = pinholeMasks(masks, slack_pixels);
  std::vector<cv::Mat> dark(masks.size()), out;
  inParallel(masks.size(), [&](size_t i) {
    if (!darkness[i].empty()) dark[i] = asPinhole(i, darkness[i]);
  });
  for (size_t i = 0; i < rays_.size(); ++i) {
    const Rays& own = rays_[i];
    cv::Mat on(own.grid, CV_8U, cv::Scalar(0));
    inParallel(size_t(own.grid.height), [&](size_t y) {
      for (int x = 0; x < own.grid.width; ++x) {
        const int row = std::min(int(y) * own.step + own.step / 2, masks[i].rows - 1);
        if (!masks[i].at<uint8_t>(row, std::min(x * own.step + own.step / 2, masks[i].cols - 1))) continue;
        if (shadowAt(i, int(y) * own.grid.width + x, pinhole, dark)) on.at<uint8_t>(int(y), x) = 255;
      }
    });
    out.push_back(on);
  }
  return out;
}

SupportFinder::Search SupportFinder::searchOf(size_t camera, const std::vector<cv::Mat>& masks) const {
  Search s;
  s.own = &rays_[camera];
  s.centre = s.own->camera.centreInWorld();
  for (size_t j = 0; j < rays_.size(); ++j) {
    if (j == camera || masks[j].empty()) continue;
    s.others.push_back(j);
    s.rays.push_back(&rays_[j]);
    s.masks.push_back(masks[j]);
    s.from.emplace_back(rays_[j].camera.cam_from_world * glm::dvec4(s.centre, 1));
  }
  s.needed = std::max<size_t>(1, (s.others.size() + 1) / 2);
  return s;
}

std::vector<Support> SupportFinder::find(const std::vector<cv::Mat>& masks, double slack_pixels,
                                         const std::vector<cv::Mat>& also) const {
  const std::vector<cv::Mat> pinhole = pinholeMasks(masks, slack_pixels);
  std::vector<cv::Mat> coarse(pinhole.size());
  for (size_t i = 0; i < pinhole.size(); ++i)
    if (!pinhole[i].empty()) coarse[i] = grown(pinhole[i], kCoarse * rays_[i].step);
  std::vector<Support> out;
  for (size_t i = 0; i < masks.size(); ++i)
    out.push_back(supportOf(i, pinhole, coarse, also.empty() ? masks[i] : cv::Mat(masks[i] | also[i])));
  return out;
}

Support SupportFinder::supportOf(size_t camera, const std::vector<cv::Mat>& masks, const std::vector<cv::Mat>& coarse,
                                 const cv::Mat& own_mask) const {
  const Search search = searchOf(camera, masks), rough = searchOf(camera, coarse);
  const Rays& own = *search.own;
  Support out{cv::Mat(own.grid, CV_16S, cv::Scalar(-2)), cv::Mat(own.grid, CV_32F, cv::Scalar(kNone))};
  if (search.others.empty()) return out;
  const cv::Mat near = grown(own_mask, kReach);
  // The fine search runs around the camera's own mask, and in blocks where a coarse one found something.
  cv::Mat worth(own.grid, CV_8U, cv::Scalar(0)), blocks(own.grid, CV_8U, cv::Scalar(0)), spread;
  cv::parallel_for_(cv::Range(0, own.grid.height), [&](const cv::Range& rows) {
    for (int y = rows.start; y < rows.end; ++y)
      for (int x = 0; x < own.grid.width; ++x) {
        worth.at<uint8_t>(y, x) = near.at<uint8_t>(std::min(y * own.step + own.step / 2, near.rows - 1),
                                                   std::min(x * own.step + own.step / 2, near.cols - 1));
        if (x % kCoarse != kCoarse / 2 || y % kCoarse != kCoarse / 2) continue;
        rough.along(own.through[size_t(y * own.grid.width + x)], 0, [&](double, const std::vector<size_t>& missed) {
          if (missed.empty()) blocks.at<uint8_t>(y, x) = 255;
          return !missed.empty();
        });
      }
  });
  cv::dilate(blocks, spread, cv::Mat::ones(2 * kCoarse - 1, 2 * kCoarse - 1, CV_8U));
  worth = worth | spread;
  const auto look = [&](int at) {
    if (!worth.at<uint8_t>(at)) return;
    size_t best = search.others.size() + 1;
    float& height = out.height_m.at<float>(at);
    search.along(own.through[size_t(at)], search.others.size(), [&](double depth, const std::vector<size_t>& missed) {
      best = std::min(best, missed.size());
      if (missed.empty())
        height = std::max(height, float(search.centre.y + depth * own.through[size_t(at)].y - ground_y_m_));
      return true;
    });
    out.missed.at<int16_t>(at) = best > search.others.size() ? int16_t(-1) : int16_t(best);
  };
  cv::parallel_for_(cv::Range(0, int(own.through.size())), [&](const cv::Range& range) {
    for (int at = range.start; at < range.end; ++at) look(at);
  });
  return out;
}

std::vector<cv::Mat> SupportFinder::seenByAll() const {
  std::vector<cv::Mat> everything, out;
  for (const Rays& r : rays_) everything.push_back(r.captured);
  for (size_t i = 0; i < rays_.size(); ++i) {
    Search search = searchOf(i, everything);
    search.needed = search.others.size();
    cv::Mat seen(rays_[i].grid, CV_8U, cv::Scalar(0));
    cv::parallel_for_(cv::Range(0, int(seen.total())), [&](const cv::Range& range) {
      for (int at = range.start; at < range.end; ++at)
        search.along(rays_[i].through[size_t(at)], search.others.size(), [&](double, const std::vector<size_t>&) {
          seen.at<uint8_t>(at) = 255;
          return false;
        });
    });
    out.push_back(seen);
  }
  return out;
}

SupportFinder::Explained SupportFinder::explain(const std::vector<cv::Mat>& masks, double slack_pixels) const {
  const std::vector<cv::Mat> pinhole = pinholeMasks(masks, slack_pixels);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const size_t count = rays_.size();
  Explained out{std::vector<double>(count, nan),
                std::vector<std::vector<double>>(count, std::vector<double>(count, nan))};
  cv::parallel_for_(cv::Range(0, int(count)), [&](const cv::Range& range) {
    for (int c = range.start; c < range.end; ++c) {
      const size_t camera = size_t(c);
      if (pinhole[camera].empty()) continue;
      const Search search = searchOf(camera, pinhole);
      if (search.others.empty()) continue;
      std::vector<int> inside;
      for (int i = 0; i < int(search.own->through.size()); ++i) {
        const int x = i % search.own->grid.width, y = i / search.own->grid.width, step = search.own->step;
        if (masks[camera].at<uint8_t>(std::min(y * step + step / 2, masks[camera].rows - 1),
                                      std::min(x * step + step / 2, masks[camera].cols - 1)))
          inside.push_back(i);
      }
      double judged = 0, supported = 0;
      std::vector<double> gained(search.others.size(), 0);
      for (size_t i = 0; i < inside.size(); i += std::max<size_t>(1, inside.size() / kBlamed)) {
        bool seen = false, all = false;
        std::vector<bool> alone(search.others.size(), false);
        search.along(search.own->through[size_t(inside[i])], 1, [&](double, const std::vector<size_t>& missed) {
          seen = true;
          all = all || missed.empty();
          if (missed.size() == 1) alone[missed[0]] = true;
          return !all;
        });
        judged += seen, supported += all;
        for (size_t k = 0; k < alone.size(); ++k) gained[k] += alone[k] && !all;
      }
      if (judged == 0) continue;
      out.share[camera] = supported / judged;
      for (size_t k = 0; k < search.others.size(); ++k)
        out.without[camera][search.others[k]] = (supported + gained[k]) / judged;
    }
  });
  return out;
}

}  // namespace fourdvt::mattes
