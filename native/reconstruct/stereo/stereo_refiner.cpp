// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/stereo_refiner.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "reconstruct/carve.h"
#include "reconstruct/surface_cleaning.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kSameAngle_deg = 1e-6;
constexpr float kBelieved = 0.05f;  // minimum weight of a valid depth; five of these are too few to move the surface

double believedShare(const DepthMap& map) {
  size_t hull = 0, believed = 0;
  for (size_t i = 0; i < map.front_m.size(); ++i) hull += map.front_m[i] > 0, believed += map.weight[i] >= kBelieved;
  return hull ? double(believed) / double(hull) : 0;
}

double angleBetween_deg(const PinholeCamera& a, const PinholeCamera& b) {
  return glm::degrees(std::acos(std::clamp(glm::dot(a.middleRayInWorld(), b.middleRayInWorld()), -1.0, 1.0)));
}

// Every camera with its neighbours; cameras without neighbours have only themselves as source.
std::vector<StereoReference> referencesOf(const std::vector<PinholeCamera>& cameras, const StereoOptions& options) {
  std::vector<StereoReference> out;
  for (size_t c = 0; c < cameras.size(); ++c) {
    StereoReference reference{cameras[c], {c}};
    for (const size_t other : comparedWith(cameras, c, options)) reference.sources.push_back(other);
    out.push_back(std::move(reference));
  }
  return out;
}

Image reducedPicture(const Image& picture, const PinholeCamera& camera) {
  Image out(camera.width, camera.height, 4);
  const cv::Mat from(picture.height, picture.width, CV_8UC4, const_cast<uint8_t*>(picture.pixels.data()));
  cv::Mat to(out.height, out.width, CV_8UC4, out.pixels.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return out;
}

}  // namespace

StereoRefiner::StereoRefiner(std::vector<PinholeCamera> cameras, const StereoOptions& options)
    : full_(std::move(cameras)), options_(options), steady_(options.kept) {
  for (const PinholeCamera& camera : full_) cameras_.push_back(reducedCamera(camera, options.reduction));
  references_ = referencesOf(cameras_, options);
}

Result<std::vector<Image>> StereoRefiner::reduced(std::span<const Image> pictures) const {
  if (pictures.size() != full_.size()) return Error{ErrorId::InvalidArgument, "stereo needs one picture per camera"};
  std::vector<Image> out;
  for (size_t c = 0; c < pictures.size(); ++c) {
    if (pictures[c].channels != 4 || pictures[c].width != full_[c].width || pictures[c].height != full_[c].height) {
      return Error{ErrorId::InvalidArgument, "stereo needs an RGBA picture of camera \"" + full_[c].name + "\" of " +
                                                 std::to_string(full_[c].width) + "x" +
                                                 std::to_string(full_[c].height) + " pixels"};
    }
    out.push_back(reducedPicture(pictures[c], cameras_[c]));
  }
  return out;
}

Result<std::vector<DepthMap>> StereoRefiner::depthMaps(std::span<const Image> pictures) {
  std::vector<DepthMap> maps;
  for (const StereoReference& reference : references_) {
    CostVolume volume;
    if (reference.sources.size() > 1) {
      FOURDVT_ASSIGN(volume, sweep_.costs(reference));
    }
    lap(times_.sweep);
    maps.push_back(semiGlobalDepth(reference, volume, options_.smoothing));
    lap(times_.smoothing);
  }
  inParallel(maps.size(), [&](int m) {
    if (maps[m].width > 0) weighByAngle(maps[m]), weighByTexture(pictures[m], maps[m]);
  });
  keepConsistent(maps, options_.agreement_m);
  believed_.clear();
  for (const DepthMap& map : maps) believed_.push_back(believedShare(map));
  lap(times_.agreement);
  return maps;
}

Result<TriangleMesh> StereoRefiner::refine(const SparseDistance& hull_distance, const TriangleMesh& hull,
                                           std::span<const Image> rgba_pictures, std::span<const CarvingView> views) {
  watch_ = {};
  times_ = {};
  FOURDVT_ASSIGN(const std::vector<Image> pictures, reduced(rgba_pictures));
  FOURDVT_TRY(sweep_.setFrame(pictures, hull));
  FOURDVT_ASSIGN(const std::vector<DepthMap> maps, depthMaps(pictures));
  const SparseDistance open_hull = withValuesInside(hull_distance);
  auto [fused, trust] = fuseDepths(hull_distance, maps, options_.fusion);
  spanMembrane(open_hull, trust, options_.membrane, fused);
  steady_.blend(pictures, maps, open_hull, fused);
  lap(times_.fusion);
  keepOutlines(open_hull, views, options_.outlines, fused);
  compact(fused);
  lap(times_.outlines);
  std::vector<const silhouette::Silhouette*> silhouettes;
  for (const CarvingView& view : views) silhouettes.push_back(view.silhouette);
  const double speck_m3 = kSpeckVoxels * std::pow(fused.voxel_m, 3);
  TriangleMesh mesh = solidSurface(fused, options_.adaptivity, [&](TriangleMesh& made) {
    dropNeedless(made, silhouettes, speck_m3);
    dropHollows(made);
  });
  lap(times_.mesh);
  return mesh;
}

std::vector<size_t> comparedWith(std::span<const PinholeCamera> cameras, size_t camera, const StereoOptions& options) {
  std::vector<std::pair<double, size_t>> near;
  for (size_t o = 0; o < cameras.size(); ++o) {
    const double angle = angleBetween_deg(cameras[camera], cameras[o]);
    if (o == camera || angle >= options.widest_deg) continue;
    const double rank = angle < options.narrowest_deg ? 2 * options.widest_deg - angle : angle;
    near.emplace_back(std::round(rank / kSameAngle_deg), o);
  }
  std::sort(near.begin(), near.end());
  near.resize(std::min(near.size(), options.neighbours));
  std::vector<size_t> out;
  for (const auto& [rank, o] : near) out.push_back(o);
  return out;
}

std::string StereoOptions::check() const {
  if (reduction < 1) return "the reduction must be at least 1";
  if (neighbours < 1 || neighbours > 4) return "stereo needs 1 to 4 neighbours";
  if (kept < 0 || kept > 1) return "the share of the frame before must be from 0 to 1";
  if (!(agreement_m > 0 && fusion.truncation_m > 0 && sweep.step_m > 0)) return "stereo's distances must be above 0";
  if (sweep.labels < 4 || sweep.labels > kMaxLabels || sweep.labels % 4 != 0)
    return "the number of planes must be a multiple of 4, at most " + std::to_string(kMaxLabels);
  return {};
}

Result<std::unique_ptr<StereoRefiner>> StereoRefiner::create(gpu::Device& device, std::vector<PinholeCamera> cameras,
                                                             const StereoOptions& options) {
  if (const std::string wrong = options.check(); !wrong.empty()) return Error{ErrorId::InvalidArgument, wrong};
  if (cameras.size() < 2) return Error{ErrorId::InvalidArgument, "stereo needs two cameras"};
  std::unique_ptr<StereoRefiner> out(new StereoRefiner(std::move(cameras), options));
  FOURDVT_ASSIGN(out->sweep_, PlaneSweep::create(device, out->cameras_, options.sweep));
  return out;
}

namespace {

constexpr int kDetail = 5,
              kAround = 9;    // window sizes, pixels: local mean that details are relative to; their variance
constexpr int kOpaque = 250;  // minimum alpha
// Variance of the details, sum of three channels, levels of 255: noise; excess over it with weight one half.
constexpr float kTextureNoise = 6, kHalf = 12;

}  // namespace

std::vector<float> textureOf(const Image& rgba) {
  const cv::Mat picture(rgba.height, rgba.width, CV_8UC4, const_cast<uint8_t*>(rgba.pixels.data()));
  cv::Mat alpha, opaque, weight, colour, mean, share;
  cv::extractChannel(picture, alpha, 3);
  cv::erode(alpha >= kOpaque, opaque, cv::Mat(), {-1, -1}, 1, cv::BORDER_REPLICATE);
  opaque.convertTo(weight, CV_32F, 1 / 255.0);
  cv::cvtColor(picture, colour, cv::COLOR_BGRA2BGR);  // channel order is irrelevant
  colour.convertTo(colour, CV_32FC3);
  for (int i = 0; i < int(weight.total()); ++i) colour.at<cv::Vec3f>(i) *= weight.at<float>(i);
  cv::boxFilter(colour, mean, -1, {kDetail, kDetail});
  cv::boxFilter(weight, share, -1, {kDetail, kDetail});
  cv::Mat detail(weight.size(), CV_32F, cv::Scalar(0)), around, counted;
  for (int i = 0; i < int(weight.total()); ++i) {
    if (weight.at<float>(i) <= 0) continue;
    const cv::Vec3f from = colour.at<cv::Vec3f>(i) - mean.at<cv::Vec3f>(i) / share.at<float>(i);
    detail.at<float>(i) = from.dot(from);
  }
  cv::boxFilter(detail, around, -1, {kAround, kAround});
  cv::boxFilter(weight, counted, -1, {kAround, kAround});
  std::vector<float> out(weight.total(), 0);
  for (int i = 0; i < int(out.size()); ++i) {
    if (counted.at<float>(i) < 1e-4f) continue;
    const float above = std::max(around.at<float>(i) / counted.at<float>(i) - kTextureNoise, 0.0f);
    out[size_t(i)] = above / (above + kHalf);
  }
  return out;
}

void weighByTexture(const Image& rgba, DepthMap& map) {
  const std::vector<float> texture = textureOf(rgba);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const size_t i = size_t(y) * map.width + x;
      map.weight[i] *= texture[size_t(map.y + y) * rgba.width + map.x + x];
      if (map.weight[i] <= 0) map.depth_m[i] = 0;
    }
}

}  // namespace fourdvt::reconstruct
