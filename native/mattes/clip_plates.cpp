// SPDX-License-Identifier: Apache-2.0
#include "mattes/clip_plates.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "base/robust.h"
#include "mattes/background_key.h"
#include "mattes/reduced.h"
#include "mattes/support.h"

namespace fourdvt::mattes {
namespace {

constexpr int kRounds = 4;
constexpr float kAlike = 2.5f, kMinNoise = 2;  // multiple of the median neighbourhood's squared difference; levels²
constexpr float kConstantNats = 8;             // against the object, where a neighbourhood never changes
constexpr float kDwells = 0.25f;               // share of the take in which a performer may stand in one place
constexpr float kTelling = 4, kPlain = 0.35f;  // texture / noise above which similarity is conclusive; weight of plain
                                               // surfaces
constexpr int kGapDivisor = 40;                // fraction of the picture's longer side: gaps in the moving region
constexpr double kMinMotion = 0.002;           // minimum share of the region that all cameras see; below it nothing
                                               // moves
constexpr float kUnknownSpread = 1e4f;         // levels², where no frame shows the background
constexpr double kKnownShare = 0.2;            // share of the samples
constexpr size_t kMinKnown = 3;
constexpr int kMarginDivisor = 60;  // fraction of the picture's longer side: possible object beside a mask
constexpr float kContradictedNats = 8, kDoubtedNats = 2;  // nats

uint8_t medianOf(std::vector<uint8_t>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Squared differences of two samples, averaged over neighbourhoods of 5 × 5 pixels and the channels, levels².
cv::Mat differenceOf(const Image& a, const Image& b) {
  cv::Mat d, planes[3], out;
  cv::subtract(matrixOf(a), matrixOf(b), d, cv::noArray(), CV_32FC3);
  cv::split(d.mul(d), planes);
  cv::blur((planes[0] + planes[1] + planes[2]) / 3, out, {5, 5});
  return out;
}

// Variance within neighbourhoods of 5 × 5 pixels, averaged over the channels, levels².
cv::Mat textureOf(const Image& picture) {
  cv::Mat values, mean, square, planes[3];
  matrixOf(picture).convertTo(values, CV_32F);
  cv::blur(values, mean, {5, 5});
  cv::blur(values.mul(values), square, {5, 5});
  cv::split(square - mean.mul(mean), planes);
  return (planes[0] + planes[1] + planes[2]) / 3;
}

// Similarity of a camera's samples to one another.
struct Likeness {
  std::vector<cv::Mat> moving;  // [sample] CV_8U: initial mask of the performer
  Image usual;                  // see ClipCamera
  cv::Mat usual_nats;
  float noise = 1;
};

// Initial mask of the performer: neighbourhoods outside the largest group of samples that agree up to noise. A
// background looks the same whenever it shows; a body moves, even where it dwells for most of the take.
Likeness likenessOf(std::span<const Image> pictures) {
  const size_t samples = pictures.size();
  const cv::Size size(pictures[0].width, pictures[0].height);
  std::vector<std::vector<cv::Mat>> alike(samples, std::vector<cv::Mat>(samples));
  std::vector<cv::Mat> count(samples);
  std::vector<float> noise;
  for (size_t a = 0; a < samples; ++a) count[a] = cv::Mat::ones(size, CV_8U);
  for (size_t a = 0; a < samples; ++a)
    for (size_t b = a + 1; b < samples; ++b) {
      const cv::Mat d = differenceOf(pictures[a], pictures[b]);
      noise.push_back(std::max(kMinNoise, median(std::vector<float>(d.begin<float>(), d.end<float>()))));
      const cv::Mat same = d < kAlike * noise.back();
      alike[a][b] = alike[b][a] = same;
      count[a] += same & 1;
      count[b] += same & 1;
    }
  cv::Mat most = cv::Mat::zeros(size, CV_8U), best = cv::Mat::zeros(size, CV_8U);
  for (size_t a = 0; a < samples; ++a) {
    best.setTo(cv::Scalar(double(a)), count[a] > most);
    most = cv::max(most, count[a]);
  }
  const int r = std::max(2, std::max(size.width, size.height) / kGapDivisor);
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1});
  Likeness out{{}, pictures[0], cv::Mat(size, CV_32F), median(noise)};
  for (int i = 0; i < int(most.total()); ++i) {
    const float share = float(most.at<uint8_t>(i)) / float(samples);
    out.usual_nats.at<float>(i) = kConstantNats * std::max(0.0f, share - kDwells) / (1 - kDwells);
    for (size_t c = 0; c < 3; ++c)
      out.usual.pixels[3 * size_t(i) + c] = pictures[best.at<uint8_t>(i)].pixels[3 * size_t(i) + c];
  }
  for (size_t k = 0; k < samples; ++k) {
    cv::Mat mask(size, CV_8U, cv::Scalar(0));
    for (int i = 0; i < int(mask.total()); ++i) {
      const size_t a = best.at<uint8_t>(i);
      mask.at<uint8_t>(i) = a == k || alike[a][k].at<uint8_t>(i) ? 0 : 255;
    }
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8U));
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, disc);  // fills the body's inside, whose pixels look alike, too
    out.moving.push_back(mask);
  }
  return out;
}

cv::Mat priorOf(const Support& support) {
  cv::Mat out(support.missed.size(), CV_32F, cv::Scalar(0));
  for (int i = 0; i < int(out.total()); ++i) {
    const int missed = support.missed.at<int16_t>(i);
    out.at<float>(i) = missed < 0 || missed > 1 ? kContradictedNats : missed == 1 ? kDoubtedNats : 0;
  }
  return out;
}

// Removes components far smaller than the largest, and those that other cameras contradict as a whole.
void keepPerformer(cv::Mat& mask, const cv::Mat& prior) {
  cv::Mat labels, stats, centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, 8, CV_32S);
  std::vector<int> doubted(size_t(count), 0);
  int largest = 0;
  for (int i = 1; i < count; ++i) largest = std::max(largest, stats.at<int>(i, cv::CC_STAT_AREA));
  for (int i = 0; i < int(mask.total()); ++i) doubted[size_t(labels.at<int>(i))] += prior.at<float>(i) > 0;
  for (int i = 0; i < int(mask.total()); ++i) {
    const int label = labels.at<int>(i), area = stats.at<int>(label, cv::CC_STAT_AREA);
    if (label > 0 && (50 * area < largest || 10 * doubted[size_t(label)] > 9 * area)) mask.at<uint8_t>(i) = 0;
  }
}

cv::Mat withMargin(const cv::Mat& mask) {
  const int r = std::max(mask.cols, mask.rows) / kMarginDivisor;
  cv::Mat out;
  cv::dilate(mask, out, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1}));
  return out;
}

}  // namespace

BackgroundModel plateBehind(std::span<const Image> pictures, std::span<const cv::Mat> masks) {
  assert(!pictures.empty() && (masks.empty() || masks.size() == pictures.size()));
  const int width = pictures[0].width, height = pictures[0].height;
  std::vector<cv::Mat> hidden;
  for (const cv::Mat& mask : masks) hidden.push_back(resizedMask(withMargin(mask), {width, height}));
  const size_t pixels = size_t(width) * size_t(height);
  const size_t least = std::max(kMinKnown, size_t(std::ceil(kKnownShare * double(pictures.size()))));
  Image median(width, height, 3);
  std::vector<uint8_t> known(pixels, 1);
  std::vector<float> spread(pixels, 0);
  cv::parallel_for_(cv::Range(0, height), [&](const cv::Range& rows) {
    std::vector<uint8_t> values, off;
    for (size_t i = size_t(rows.start) * size_t(width); i < size_t(rows.end) * size_t(width); ++i) {
      size_t shown = 0;
      for (const cv::Mat& h : hidden) shown += h.at<uint8_t>(int(i)) == 0;
      const bool enough = hidden.empty() || shown >= least;
      known[i] = enough;
      for (size_t c = 0; c < 3; ++c) {
        values.clear();
        for (size_t k = 0; k < pictures.size(); ++k)
          if (!enough || hidden.empty() || hidden[k].at<uint8_t>(int(i)) == 0)
            values.push_back(pictures[k].pixels[3 * i + c]);
        const uint8_t middle = median.pixels[3 * i + c] = medianOf(values);
        off.clear();
        for (const uint8_t v : values) off.push_back(uint8_t(std::abs(int(v) - middle)));
        const float deviation = 1.4826f * float(medianOf(off));
        spread[i] += deviation * deviation / 3;
      }
    }
  });
  BackgroundModel out = makeBackgroundModel({&median, 1});
  out.plates = int(std::clamp<size_t>(pictures.size() / 3, 1, 10));
  // Flicker beyond the sensor's noise, estimated by the median pixel.
  const float typical = fourdvt::median(spread);
  for (size_t i = 0; i < pixels; ++i)
    out.extra[i] = known[i] ? out.extra[i] + std::max(0.0f, spread[i] - 3 * typical) : kUnknownSpread;
  if (std::find(known.begin(), known.end(), 0) != known.end()) out.known = std::move(known);
  return out;
}

cv::Mat costOfTheUsual(const ClipCamera& clip, const Image& picture) {
  const cv::Mat difference = differenceOf(clip.usual, picture), texture = textureOf(picture);
  cv::Mat out(difference.size(), CV_32F, cv::Scalar(0));
  for (int i = 0; i < int(out.total()); ++i) {
    if (difference.at<float>(i) >= kAlike * clip.noise) continue;
    // Plain cloth is self-similar while it moves.
    out.at<float>(i) =
        clip.usual_nats.at<float>(i) * std::clamp(texture.at<float>(i) / (kTelling * clip.noise), kPlain, 1.0f);
  }
  return out;
}

std::vector<ClipCamera> separateClips(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m,
                                      const std::vector<std::vector<Image>>& pictures) {
  const size_t samples = pictures[0].size();
  std::vector<capture::CaptureCamera> small;
  for (const capture::CaptureCamera& c : cameras) small.push_back(reduced(c, reductionFor(c, kClipPixels)));
  const SupportFinder finder(small, ground_y_m);
  const double slack = 2;
  std::vector<ClipCamera> out(cameras.size());
  const std::vector<cv::Mat> seen = finder.seenByAll();
  inParallel(cameras.size(), [&](size_t i) {
    const cv::Mat region = finder.fullSize(seen[i], i);
    Likeness likeness = likenessOf(pictures[i]);
    out[i].masks = std::move(likeness.moving);
    out[i].usual = std::move(likeness.usual);
    out[i].usual_nats = likeness.usual_nats, out[i].noise = likeness.noise;
    double moved = 0;
    for (cv::Mat& mask : out[i].masks) mask &= region, moved += cv::countNonZero(mask);
    if (moved < kMinMotion * double(samples) * std::max(1, cv::countNonZero(region)))
      for (cv::Mat& mask : out[i].masks) mask = region.clone();
  });
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::vector<cv::Mat>> priors(cameras.size(), std::vector<cv::Mat>(samples));
    for (size_t k = 0; k < samples; ++k) {
      std::vector<cv::Mat> masks;
      for (const ClipCamera& c : out) masks.push_back(c.masks[k]);
      const std::vector<Support> supports = finder.find(masks, round == 0 ? 4 * slack : slack);
      for (size_t i = 0; i < cameras.size(); ++i) priors[i][k] = finder.fullSize(priorOf(supports[i]), i);
    }
    inParallel(cameras.size(), [&](size_t i) {
      ClipCamera& c = out[i];
      for (size_t k = 0; k < samples; ++k) c.masks[k] &= priors[i][k] < kContradictedNats;
      const BackgroundModel plate = plateBehind(pictures[i], c.masks);
      std::vector<KeyCut> keys;
      c.colours = {};
      for (size_t k = 0; k < samples; ++k) {
        keys.emplace_back(pictures[i][k], plate);
        keys.back().count(c.masks[k], c.colours);
      }
      for (size_t k = 0; k < samples; ++k) {
        keys[k].use(c.colours);
        c.masks[k] = keys[k].cut(priors[i][k] + costOfTheUsual(c, pictures[i][k]));
        keepPerformer(c.masks[k], priors[i][k]);
      }
    });
  }
  return out;
}

}  // namespace fourdvt::mattes
