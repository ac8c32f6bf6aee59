// SPDX-License-Identifier: Apache-2.0
// Sources: Georgios D. Evangelidis, Emmanouil Z. Psarakis, "Parametric Image Alignment Using Enhanced Correlation
// Coefficient Maximization", IEEE Transactions on Pattern Analysis and Machine Intelligence 30(10), 2008. Stuart Geman,
// Donald E. McClure, "Statistical Methods for Tomographic Image Reconstruction", Bulletin of the International
// Statistical Institute 52(4), 1987.
#include "mattes/background_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "base/robust.h"

namespace fourdvt::mattes {
namespace {

constexpr float kShift_pixels = 0.1f;  // shake of a studio's cameras
// Chroma key backdrop: minimum distance of its median colour from grey in the CbCr plane of BT.709, levels of 255;
// minimum share of the plate with that colour; tolerances as shares of the distance: in hue, which light does not
// change, and in the amount of light.
constexpr float kBackdropChroma = 36, kBackdropShare = 0.7f, kBackdropHue = 0.1f, kBackdropLight = 0.6f;

// Variance between plates over 5 × 5 pixels, beyond the median of all pixels (sensor noise).
cv::Mat flicker(const std::vector<cv::Mat>& plates, const cv::Mat& mean) {
  cv::Mat sum = cv::Mat::zeros(mean.size(), CV_32F);
  for (const cv::Mat& plate : plates) {
    cv::Mat d, planes[3];
    cv::subtract(plate, mean, d, cv::noArray(), CV_32FC3);
    cv::split(d.mul(d), planes);
    sum += (planes[0] + planes[1] + planes[2]) / 3;
  }
  sum /= double(plates.size() - 1);
  cv::blur(sum, sum, {5, 5});
  const float noise = median(std::vector<float>(sum.begin<float>(), sum.end<float>()));
  // With two plates the mean of 75 squares deviates by a sixth; 1.5 times the noise is well above that.
  return cv::max(sum - 1.5 * noise, 0.0);
}

// CV_32F: largest squared slope of the three channels per pixel, levels², by Sobel's filter. `levels`: CV_32FC3.
cv::Mat squaredGradient(const cv::Mat& levels) {
  cv::Mat dx, dy, planes[3];
  cv::Sobel(levels, dx, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(levels, dy, CV_32F, 0, 1, 3, 0.125);
  cv::Mat squared = dx.mul(dx) + dy.mul(dy);
  cv::split(squared, planes);
  return cv::max(planes[0], cv::max(planes[1], planes[2]));
}

// Variance due to a shift of kShift_pixels at the plates' edges.
cv::Mat shiftVariance(const cv::Mat& mean) { return kShift_pixels * kShift_pixels * squaredGradient(mean); }

// Variance due to a video's coarser chroma (4:2:0) at colour edges of the plates, which are stored with full chroma.
cv::Mat chromaVariance(const cv::Mat& mean) {
  cv::Mat luma, grey, colour, coarse, planes[3];
  cv::transform(mean, luma, cv::Matx13f(0.2126f, 0.7152f, 0.0722f));
  cv::merge(std::vector<cv::Mat>{luma, luma, luma}, grey);
  colour = mean - grey;
  cv::blur(colour, coarse, {3, 3});
  cv::Mat lost = colour - coarse;
  cv::split(lost.mul(lost), planes);
  cv::Mat sum = (planes[0] + planes[1] + planes[2]) / 3;
  cv::blur(sum, sum, {3, 3});
  return cv::max(sum - 3 * median(std::vector<float>(sum.begin<float>(), sum.end<float>())), 0.0);
}

}  // namespace

BackgroundModel makeBackgroundModel(std::span<const Image> plates) {
  assert(!plates.empty());
  BackgroundModel model{plates[0].width, plates[0].height, int(plates.size()), {}, {}};
  const cv::Size size(model.width, model.height);
  std::vector<cv::Mat> pictures;
  model.mean.resize(3 * size_t(size.area()));
  model.extra.resize(size_t(size.area()));
  cv::Mat mean(size, CV_32FC3, model.mean.data()), extra(size, CV_32F, model.extra.data());
  mean = 0;
  for (const Image& plate : plates) {
    assert(plate.channels == 3 && plate.width == model.width && plate.height == model.height);
    pictures.emplace_back(size, CV_8UC3, const_cast<uint8_t*>(plate.pixels.data()));
    cv::accumulate(pictures.back(), mean);
  }
  mean *= 1.0 / double(plates.size());
  cv::Mat sum = shiftVariance(mean) + chromaVariance(mean);
  if (plates.size() > 1) sum += flicker(pictures, mean);
  sum.copyTo(extra);
  return model;
}

Image meanPicture(const BackgroundModel& model) {
  Image out(model.width, model.height, 3);
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = static_cast<uint8_t>(std::lround(model.mean[i]));
  return out;
}

bool isChromaPlate(const Image& plate) {
  const size_t pixels = size_t(plate.width) * plate.height;
  std::vector<float> blue, red;
  for (size_t i = 0; i < pixels; ++i) {
    const uint8_t* p = &plate.pixels[3 * i];
    const float luma = 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
    blue.push_back((p[2] - luma) / 1.8556f);
    red.push_back((p[0] - luma) / 1.5748f);
  }
  const float cb = median(blue), cr = median(red), chroma = std::hypot(cb, cr);
  if (!(chroma >= kBackdropChroma)) return false;
  size_t alike = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const float along = (blue[i] * cb + red[i] * cr) / chroma, across = (red[i] * cb - blue[i] * cr) / chroma;
    alike += std::abs(across) <= kBackdropHue * chroma && std::abs(along - chroma) <= kBackdropLight * chroma;
  }
  return double(alike) >= kBackdropShare * double(pixels);
}

namespace {

constexpr float kMinGain = 0.005f, kMinOffset = 1;           // offset: levels of 255
constexpr float kMaxGain = 1.6f;                             // minimum: its inverse
constexpr double kMinShift_pixels = 0.15, kMaxShift = 0.02;  // kMaxShift: share of the picture's diagonal
constexpr double kBetter = 0.97;  // maximum ratio of robust differences, fitted to original; above it the plates stay
                                  // unchanged
constexpr int kBins = 12;         // brightness bins of the noise
constexpr size_t kMinInBin = 400;
constexpr int kSide = 640;  // maximum side of the picture for the homography

struct Gain {
  float gain = 1, offset = 0;
};

cv::Mat wrap(const Image& picture) {
  const cv::Mat bytes(picture.height, picture.width, CV_8UC3, const_cast<uint8_t*>(picture.pixels.data()));
  cv::Mat out;
  bytes.convertTo(out, CV_32F);
  return out;
}

// Every n-th value of one channel, about 40,000 in all.
struct Samples {
  std::vector<float> plate, picture;
};
Samples samplesOf(const cv::Mat& plate, const cv::Mat& picture, int channel) {
  Samples out;
  const size_t step = std::max<size_t>(1, plate.total() / 40000);
  for (size_t i = 0; i < plate.total(); i += step) {
    const float a = plate.at<cv::Vec3f>(int(i))[channel], b = picture.at<cv::Vec3f>(int(i))[channel];
    if (a < 3 || a > 250 || b < 3 || b > 250) continue;  // clipped: no evidence of the gain
    out.plate.push_back(a + kToe);
    out.picture.push_back(b + kToe);
  }
  return out;
}

// Gain by iteratively reweighted least squares with the weights of Geman and McClure (1987), from the median ratio.
Gain fitGain(const Samples& s) {
  if (s.plate.size() < 500) return {};
  std::vector<float> ratios(s.plate.size());
  for (size_t i = 0; i < ratios.size(); ++i) ratios[i] = s.picture[i] / s.plate[i];
  Gain g{median(ratios), 0};
  std::vector<float> off(s.plate.size());
  for (int round = 0; round < 12; ++round) {
    for (size_t i = 0; i < off.size(); ++i) off[i] = std::abs(s.picture[i] - g.gain * s.plate[i] - g.offset);
    const float scale = std::max(1.0f, 2 * median(off) / 0.6745f);
    double w = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (size_t i = 0; i < off.size(); ++i) {
      const double r = off[i] / scale, weight = 1 / ((1 + r * r) * (1 + r * r));
      w += weight, x += weight * s.plate[i], y += weight * s.picture[i];
      xx += weight * s.plate[i] * s.plate[i], xy += weight * s.plate[i] * s.picture[i];
    }
    const double spread = xx / w - x / w * (x / w);
    // Gain and offset of a plate of one brightness are ambiguous: the offset stays 0.
    if (spread < 100) {
      g = {float(xy / xx), 0};
    } else {
      g.gain = float((xy / w - x / w * (y / w)) / spread);
      g.offset = float(y / w - g.gain * x / w);
    }
  }
  if (!(g.gain > 1 / kMaxGain && g.gain < kMaxGain)) return {};
  return g;
}

cv::Mat withGains(const cv::Mat& plate, const Gain (&gains)[3]) {
  cv::Mat out;
  cv::multiply(plate + cv::Scalar::all(kToe), cv::Scalar(gains[0].gain, gains[1].gain, gains[2].gain), out);
  return out + cv::Scalar(gains[0].offset - kToe, gains[1].offset - kToe, gains[2].offset - kToe);
}

bool fitGains(const cv::Mat& plate, const cv::Mat& picture, Gain (&gains)[3]) {
  bool clear = false;
  for (int c = 0; c < 3; ++c) {
    gains[c] = fitGain(samplesOf(plate, picture, c));
    clear |= std::abs(gains[c].gain - 1) > kMinGain || std::abs(gains[c].offset) > kMinOffset;
  }
  if (!clear)
    for (Gain& g : gains) g = {};
  return clear;
}

// Maximum difference over the channels, CV_32F.
cv::Mat difference(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat d, planes[3];
  cv::absdiff(a, b, d);
  cv::split(d, planes);
  return cv::max(planes[0], cv::max(planes[1], planes[2]));
}

cv::Mat grey(const cv::Mat& picture) {
  cv::Mat out;
  cv::transform(picture, out, cv::Matx13f(0.2126f, 0.7152f, 0.0722f));
  return out;
}

double meanShift(const cv::Mat& h, const cv::Size& size) {
  const std::vector<cv::Point2d> corners{
      {0, 0}, {double(size.width), 0}, {0, double(size.height)}, {double(size.width), double(size.height)}};
  std::vector<cv::Point2d> moved;
  cv::perspectiveTransform(corners, moved, h);
  double sum = 0;
  for (size_t i = 0; i < 4; ++i) sum += cv::norm(moved[i] - corners[i]);
  return sum / 4;
}

// Maps pixels of the picture to pixels of the plate, centres at integers, by the enhanced correlation coefficient
// (Evangelidis and Psarakis 2008); empty if none improves on the identity.
cv::Mat fitHomography(const cv::Mat& plate, const cv::Mat& picture) {
  const double scale = std::min(1.0, double(kSide) / std::max(plate.cols, plate.rows));
  cv::Mat a, b, off, mask;
  cv::resize(grey(plate), a, {}, scale, scale, cv::INTER_AREA);
  cv::resize(grey(picture), b, {}, scale, scale, cv::INTER_AREA);
  cv::resize(difference(plate, picture), off, {}, scale, scale, cv::INTER_AREA);
  const float limit = std::max(12.0f, 6 * median(std::vector<float>(off.begin<float>(), off.end<float>())));
  mask = off < limit;
  cv::Mat h = cv::Mat::eye(3, 3, CV_32F);
  try {
    cv::findTransformECC(b, a, h, cv::MOTION_HOMOGRAPHY, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-5},
                         mask, 5);
  } catch (const cv::Exception&) {
    return {};  // no structure, or no convergence
  }
  h.convertTo(h, CV_64F);
  const cv::Mat grow = (cv::Mat_<double>(3, 3) << scale, 0, 0, 0, scale, 0, 0, 0, 1);
  h = grow.inv() * h * grow;
  const double shift = meanShift(h, plate.size()), diagonal = std::hypot(plate.cols, plate.rows);
  if (!(shift > kMinShift_pixels && shift < kMaxShift * diagonal)) return {};
  return h;
}

double robustCost(const cv::Mat& plate, const cv::Mat& picture) {
  return cv::mean(cv::min(difference(plate, picture), 24.0))[0];
}

// Adds to `extra` the variance by brightness (sensor noise, compression) and at edges (sharpness, residual shift)
// beyond that of the median pixel. Medians exclude the object.
void addMeasuredNoise(const cv::Mat& plate, const cv::Mat& picture, cv::Mat& extra) {
  const cv::Mat light = grey(plate), gradient = squaredGradient(plate);
  cv::Mat d = plate - picture, squares, planes[3];
  cv::split(d.mul(d), planes);
  squares = (planes[0] + planes[1] + planes[2]) / 3;
  std::vector<float> bins[kBins], edges, all;
  for (int i = 0; i < int(squares.total()); ++i) {
    const float value = squares.at<float>(i), slope = gradient.at<float>(i);
    all.push_back(value);
    if (slope > 64)
      edges.push_back(value / slope);
    else if (slope < 9)
      bins[std::clamp(int(light.at<float>(i) / 256 * kBins), 0, kBins - 1)].push_back(value);
  }
  const float common = median(all), shift2 = edges.size() < kMinInBin ? 0 : std::min(median(edges), 0.25f);
  float noise[kBins] = {};
  for (int b = 0; b < kBins; ++b)
    if (bins[b].size() >= kMinInBin) noise[b] = std::min(std::max(0.0f, median(bins[b]) - common), 3 * common + 4);
  for (int i = 0; i < int(extra.total()); ++i)
    extra.at<float>(i) += noise[std::clamp(int(light.at<float>(i) / 256 * kBins), 0, kBins - 1)] +
                          std::max(0.0f, shift2 - 0.01f) * gradient.at<float>(i);
}

}  // namespace

PlateFit fitPlate(const BackgroundModel& plates, const Image& given) {
  assert(given.channels == 3 && given.width == plates.width && given.height == plates.height);
  PlateFit out{plates};
  const cv::Size size(plates.width, plates.height);
  cv::Mat mean(size, CV_32FC3, out.background.mean.data()), extra(size, CV_32F, out.background.extra.data());
  const cv::Mat picture = wrap(given);
  Gain gains[3];
  cv::Mat fitted = mean, spread = extra.clone();
  bool changed = false;
  if (fitGains(fitted, picture, gains)) {
    const cv::Mat better = withGains(mean, gains);
    changed = robustCost(better, picture) < kBetter * robustCost(fitted, picture);
    if (changed)
      fitted = better;
    else
      std::fill(std::begin(gains), std::end(gains), Gain{});
  }
  if (const cv::Mat h = fitHomography(fitted, picture); !h.empty()) {
    const int how = cv::INTER_CUBIC | cv::WARP_INVERSE_MAP;
    cv::Mat moved, moved_spread;
    cv::warpPerspective(mean, moved, h, size, how, cv::BORDER_REPLICATE);
    Gain again[3];
    fitGains(moved, picture, again);
    const cv::Mat better = withGains(moved, again);
    if (robustCost(better, picture) < kBetter * robustCost(fitted, picture)) {
      cv::warpPerspective(extra, moved_spread, h, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
      std::copy(std::begin(again), std::end(again), std::begin(gains));
      fitted = better, spread = moved_spread, changed = true;
      out.shift_pixels = float(meanShift(h, size));
    }
  }
  for (size_t c = 0; c < 3; ++c) out.gain[c] = gains[c].gain;
  const cv::Mat left = difference(fitted, picture);
  out.residual_levels = median(std::vector<float>(left.begin<float>(), left.end<float>()));
  if (!changed) return out;
  addMeasuredNoise(fitted, picture, spread);
  fitted.copyTo(mean);
  spread.copyTo(extra);
  return out;
}

}  // namespace fourdvt::mattes
