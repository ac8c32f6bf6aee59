// SPDX-License-Identifier: Apache-2.0
#include "mattes/joint_mattes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "base/parallel.h"
#include "mattes/background_key.h"
#include "mattes/background_model.h"
#include "mattes/hints.h"
#include "mattes/reduced.h"
#include "mattes/support.h"

namespace fourdvt::mattes {
namespace {

constexpr double kCutPixels = 450'000;   // size of the first, reduced cut
constexpr double kComponentShare = 0.9;  // share of a component on the floor or contradicted, from which on it is
                                         // removed
constexpr double kMinComponent = 0.01;   // minimum size, as a share of the camera's largest component
constexpr float kLooseHull = 5;          // number of other cameras up to which their hull is too loose a demand
constexpr int kDepths = 5;               // classes of a pixel's depth in the hull of the others
constexpr double kSteep = 1.5;           // height per length across the line of sight
constexpr size_t kManyCameras = 7;       // number of other cameras from which on one may be wrong without a doubt

// Height of the performer: nearly the highest place that the masks support.
double performerHeight(const std::vector<Support>& supports) {
  std::vector<float> heights;
  for (const Support& s : supports)
    for (int i = 0; i < int(s.missed.total()); ++i)
      if (s.missed.at<int16_t>(i) == 0) heights.push_back(s.height_m.at<float>(i));
  if (heights.empty()) return 0;
  const auto at = heights.begin() + std::ptrdiff_t(0.9 * double(heights.size() - 1));
  std::nth_element(heights.begin(), at, heights.end());
  return std::max(0.0f, *at);
}

enum Doubt : uint8_t { kNoDoubt = 0, kOther = 64, kOnFloor = 128, kContradicted = 255 };

// Depth class of grid places in the hull of the others, CV_8U: 0 at its rim … kDepths - 1 in its core.
cv::Mat depthOf(const Support& support) {
  cv::Mat distance, out;
  cv::distanceTransform(support.missed == 0, distance, cv::DIST_L2, 3);
  double deepest = 0;
  cv::minMaxLoc(distance, nullptr, &deepest);
  distance.convertTo(out, CV_8U, deepest > 0 ? (kDepths - 0.01) / deepest : 0, -0.5);
  return out;
}

// Heights above the floor below which a patch may lie on it: in any case, and where it looks like a shadow. Hulls of
// flat patches bulge.
struct Floor {
  double flat_m, shadow_m;
};

// Cost against the object per pixel of one camera, nats, from the other cameras' masks; and its reason.
struct Prior {
  cv::Mat cost;   // CV_32F
  cv::Mat doubt;  // CV_8U, Doubt
};

double shareOf(const cv::Mat& part, const cv::Mat& whole) {
  const int all = cv::countNonZero(whole);
  return all > 0 ? double(cv::countNonZero(part & whole)) / all : 1;
}

// Removes components that the others doubt as a whole and those far smaller than the largest, except where a stroke
// marks them.
void dropComponents(cv::Mat& mask, const cv::Mat& doubt, const cv::Mat& hints) {
  cv::Mat labels, stats, centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, 8, CV_32S);
  std::vector<int> doubted(size_t(count), 0);
  std::vector<bool> marked(size_t(count), false);
  int largest = 0;
  for (int i = 1; i < count; ++i) largest = std::max(largest, stats.at<int>(i, cv::CC_STAT_AREA));
  for (int i = 0; i < int(mask.total()); ++i) {
    const size_t label = size_t(labels.at<int>(i));
    doubted[label] += doubt.at<uint8_t>(i) > 0;
    if (!hints.empty() && hints.at<float>(i) < 0) marked[label] = true;
  }
  for (int i = 0; i < int(mask.total()); ++i) {
    const int label = labels.at<int>(i), area = stats.at<int>(label, cv::CC_STAT_AREA);
    if (label > 0 && !marked[size_t(label)] &&
        (doubted[size_t(label)] > kComponentShare * area || area < kMinComponent * largest))
      mask.at<uint8_t>(i) = 0;
  }
}

void obey(const cv::Mat& hints, Image& matte) {
  for (int i = 0; i < int(hints.total()); ++i)
    if (const float h = hints.at<float>(i); std::abs(h) >= kObeyed) matte.pixels[size_t(i)] = h < 0 ? 255 : 0;
}

// State of one camera during the iterations.
struct Work {
  std::optional<BackgroundModel> fitted;  // full size; else the view's plates
  std::optional<KeyCut> key;              // at the reduced size
  cv::Mat first, mask, hints, doubt;      // at the reduced size
  cv::Mat own_cost;                       // at the reduced size: hints and the view's own costs
  cv::Mat darkness;                       // at the reduced size, see SupportFinder::shadows
  cv::Mat cost;                           // costs of the last round
};

}  // namespace

struct JointMattes::Parts {
  JointOptions options;
  std::vector<int> reduction;
  std::optional<SupportFinder> finder;

  Prior priorOf(const Support& support, const cv::Mat& shadow, size_t camera, size_t others,
                const std::vector<float>& demanded, const Floor& floor) const;
  void settle(std::span<const MatteView> views, std::vector<Work>& work, std::vector<CameraMatte>& out) const;
  std::vector<float> demandedNats(const std::vector<Support>& supports, const std::vector<cv::Mat>& masks) const;
};

// Gain of a pixel in the hull of all others: the log odds of object in the current masks, by depth in that hull. The
// hull's core is reliable, its rim often is not.
std::vector<float> JointMattes::Parts::demandedNats(const std::vector<Support>& supports,
                                                    const std::vector<cv::Mat>& masks) const {
  const auto seeing =
      std::count_if(masks.begin(), masks.end(), [](const cv::Mat& m) { return cv::countNonZero(m) > 0; });
  const float most = options.demanded_nats * std::max(0.0f, float(seeing) - 1 - kLooseHull);
  std::vector<double> all(kDepths, 1), object(kDepths, 0.5);
  for (size_t i = 0; i < masks.size(); ++i) {
    if (cv::countNonZero(masks[i]) == 0) continue;  // the performer may be outside of this picture
    const cv::Mat depth = depthOf(supports[i]);
    for (int k = 0; k < int(depth.total()); ++k) {
      if (supports[i].missed.at<int16_t>(k) != 0) continue;
      const int step = finder->stepOf(i), x = k % depth.cols * step + step / 2, y = k / depth.cols * step + step / 2;
      const int bin = depth.at<uint8_t>(k);
      all[size_t(bin)] += 1;
      object[size_t(bin)] += masks[i].at<uint8_t>(std::min(y, masks[i].rows - 1), std::min(x, masks[i].cols - 1)) != 0;
    }
  }
  std::vector<float> out;
  for (int bin = 0; bin < kDepths; ++bin) {
    const double share = std::clamp(object[size_t(bin)] / all[size_t(bin)], 0.001, 0.999);
    out.push_back(std::clamp(float(std::log(share / (1 - share))), 0.0f, most));
  }
  return out;
}

Prior JointMattes::Parts::priorOf(const Support& support, const cv::Mat& shadow, size_t camera, size_t others,
                                  const std::vector<float>& demanded, const Floor& floor) const {
  const cv::Mat depth = depthOf(support);
  const int forgiven = others >= kManyCameras ? 1 : 0;
  cv::Mat cost(support.missed.size(), CV_32F, cv::Scalar(0)), doubt(support.missed.size(), CV_8U, cv::Scalar(kNoDoubt));
  for (int i = 0; i < int(cost.total()); ++i) {
    const int missed = support.missed.at<int16_t>(i);
    const float height = support.height_m.at<float>(i);
    float& nats = cost.at<float>(i);
    uint8_t& why = doubt.at<uint8_t>(i);
    if (missed < 0) {
      if (options.background_unseen) nats = options.contradicted_nats, why = kContradicted;
    } else if (missed > forgiven) {
      const bool sure = missed > forgiven + 1 || others < 3;
      nats = sure ? options.contradicted_nats : options.doubted_nats, why = kContradicted;
    } else if (options.floor && missed == 0 && shadow.at<uint8_t>(i) && height < floor.shadow_m) {
      nats = options.shadow_nats, why = kOnFloor;
    } else if (options.floor && missed == 0 && height < floor.flat_m) {
      nats = options.floor_nats, why = kOnFloor;
    } else if (missed == 0) {
      nats = -demanded[depth.at<uint8_t>(i)];
    }
  }
  return {finder->fullSize(cost, camera), finder->fullSize(doubt, camera)};
}

JointMattes::JointMattes(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m,
                         const JointOptions& options)
    : parts_(new Parts{options, {}, {}}) {
  std::vector<capture::CaptureCamera> small;
  for (const capture::CaptureCamera& c : cameras) {
    parts_->reduction.push_back(options.alone ? 1 : reductionFor(c, kCutPixels));
    small.push_back(reduced(c, parts_->reduction.back()));
  }
  if (!options.alone) parts_->finder.emplace(small, ground_y_m);
}
JointMattes::~JointMattes() = default;

namespace {

cv::Mat sum(const cv::Mat& a, const cv::Mat& b) { return a.empty() ? b : b.empty() ? a : cv::Mat(a + b); }

// 128 × picture / plate, averaged over 5 × 5 pixels; 0 where no plate shows the background.
cv::Mat darknessOf(const Image& picture, const BackgroundModel& background) {
  const cv::Size size(background.width, background.height);
  const cv::Mat mean(size, CV_32FC3, const_cast<float*>(background.mean.data()));
  cv::Mat light, plate, out;
  cv::transform(matrixOf(picture), light, cv::Matx13f(0.2126f, 0.7152f, 0.0722f));
  light.convertTo(light, CV_32F, 1, kToe);
  cv::transform(mean, plate, cv::Matx13f(0.2126f, 0.7152f, 0.0722f));
  plate += kToe;
  cv::blur(light, light, {5, 5});
  cv::blur(plate, plate, {5, 5});
  cv::Mat(light / plate * 128).convertTo(out, CV_8U);
  out = cv::max(out, 1);
  for (size_t i = 0; i < background.known.size(); ++i)
    if (!background.known[i]) out.at<uint8_t>(int(i)) = 0;
  return out;
}

void beginWork(const MatteView& view, int reduction, Work& w, CameraMatte& out) {
  const cv::Size small = reducedSize(view.picture.width, view.picture.height, reduction);
  if (!view.hints.empty()) cv::resize(view.hints, w.hints, small, 0, 0, cv::INTER_AREA);
  if (!view.more_cost.empty()) cv::resize(view.more_cost, w.own_cost, small, 0, 0, cv::INTER_AREA);
  w.own_cost = sum(w.own_cost, w.hints);
  if (!view.plates) {
    w.mask = resizedMask(matrixOf(view.given) >= 128, small);
    w.first = w.mask.clone();
    return;
  }
  if (view.fit_plates) {
    PlateFit fitted = fitPlate(*view.plates, view.picture);
    out.shift_pixels = fitted.shift_pixels, out.gain = fitted.gain[1], out.residual_levels = fitted.residual_levels;
    w.fitted = std::move(fitted.background);
  }
  const Image picture = reduced(view.picture, reduction);
  const BackgroundModel background = reduced(w.fitted ? *w.fitted : *view.plates, reduction);
  w.darkness = darknessOf(picture, background);
  w.key.emplace(picture, background);
  if (view.colours)
    w.key->use(*view.colours);
  else
    w.key->learn(w.key->cut(w.own_cost));
  w.first = w.mask = w.key->cut(w.own_cost);
}

// CameraMatte::dropped at the reduced size.
cv::Mat droppedOf(const Work& w) {
  cv::Mat out = cv::Mat::zeros(w.mask.size(), CV_8U);
  const cv::Mat why = cv::max(w.doubt, cv::Scalar(kOther)), gone = w.first & ~w.mask;
  why.copyTo(out, gone);
  return out;
}

// Matte at full size: a second cut along the outline of the reduced mask.
Image finished(const MatteView& view, const Work& w, int reduction) {
  if (!w.key) {
    if (view.given_is_final) return view.given;
    Image out = view.given;
    const cv::Mat keep = resizedMask(w.mask, {out.width, out.height});
    cv::Mat grown;
    cv::dilate(keep, grown, cv::Mat::ones(2 * reduction + 3, 2 * reduction + 3, CV_8U));
    for (int i = 0; i < int(grown.total()); ++i)
      if (!grown.at<uint8_t>(i)) out.pixels[size_t(i)] = 0;
    return out;
  }
  if (reduction == 1) return w.key->matte(w.mask);
  const cv::Size size(view.picture.width, view.picture.height);
  const cv::Mat given = resizedMask(w.mask, size), box = cv::Mat::ones(4 * reduction + 3, 4 * reduction + 3, CV_8U);
  cv::Mat inner, outer, cost;
  cv::erode(given, inner, box, {-1, -1}, 1, cv::BORDER_REPLICATE);
  cv::dilate(given, outer, box, {-1, -1}, 1, cv::BORDER_REPLICATE);
  if (!w.cost.empty()) cv::resize(w.cost, cost, size, 0, 0, cv::INTER_LINEAR);
  KeyCut key(view.picture, w.fitted ? *w.fitted : *view.plates);
  if (view.colours)
    key.use(*view.colours);
  else
    key.learn(given);
  return key.matte(key.cutNear(given, outer & ~inner, sum(cost, sum(view.hints, view.more_cost))));
}

}  // namespace

// Runs one round: the support of every pixel by the other cameras, and a new cut of all masks.
void JointMattes::Parts::settle(std::span<const MatteView> views, std::vector<Work>& work,
                                std::vector<CameraMatte>& out) const {
  std::vector<cv::Mat> masks, first, darkness;
  for (const Work& w : work) masks.push_back(w.mask), first.push_back(w.first), darkness.push_back(w.darkness);
  const auto sees = [&](size_t i) { return cv::countNonZero(masks[i]) > 0; };
  size_t seeing = 0;
  for (size_t i = 0; i < masks.size(); ++i) seeing += sees(i);
  const std::vector<Support> supports = finder->find(masks, options.slack_pixels, first);
  const std::vector<cv::Mat> shadows = finder->shadows(masks, darkness, options.slack_pixels);
  const std::vector<float> demanded = demandedNats(supports, masks);
  // Masks grown by the slack reach that far above the floor, and further for cameras that look down steeply.
  const double slack_m = kSteep * options.slack_pixels * finder->footprint_m(), height_m = performerHeight(supports);
  const Floor floor{options.floor_share * height_m + slack_m, options.shadow_share * height_m + slack_m};
  inParallel(views.size(), [&](size_t i) {
    Work& w = work[i];
    if (!w.key && views[i].given_is_final) return;
    const Prior prior = priorOf(supports[i], shadows[i], i, seeing - sees(i), demanded, floor);
    if (w.doubt.empty()) {
      out[i].supported = 1 - shareOf(prior.doubt == kContradicted, w.first);
      w.doubt = prior.doubt.clone();
    }
    prior.doubt.copyTo(w.doubt, w.doubt == kNoDoubt);  // the first reason counts
    if (w.key) {
      if (!views[i].colours) w.key->learn(w.mask & (prior.doubt == kNoDoubt));
      w.cost = prior.cost;
      w.mask = w.key->cut(sum(prior.cost, w.own_cost));
    }
    dropComponents(w.mask, prior.doubt, w.hints);
  });
}

std::vector<CameraMatte> JointMattes::make(std::span<const MatteView> views) const {
  const Parts& p = *parts_;
  assert(views.size() == p.reduction.size());
  std::vector<Work> work(views.size());
  std::vector<CameraMatte> out(views.size());
  const auto finish = [&](size_t i) {
    const Work& w = work[i];
    const cv::Size size(views[i].picture.width, views[i].picture.height);
    out[i].matte = finished(views[i], w, p.reduction[i]);
    if (!views[i].hints.empty() && !views[i].given_is_final) obey(views[i].hints, out[i].matte);
    out[i].kept = shareOf(w.mask, w.first);
    out[i].own = resizedMask(w.first, size);
    if (!w.doubt.empty()) cv::resize(droppedOf(w), out[i].dropped, size, 0, 0, cv::INTER_NEAREST);
    work[i] = {};
  };
  inParallel(views.size(), [&](size_t i) {
    beginWork(views[i], p.reduction[i], work[i], out[i]);
    if (p.options.alone) finish(i);
  });
  if (p.options.alone) return out;
  for (int round = 0; round < p.options.rounds; ++round) p.settle(views, work, out);
  inParallel(views.size(), finish);
  return out;
}

}  // namespace fourdvt::mattes
