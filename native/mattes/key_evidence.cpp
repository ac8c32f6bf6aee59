// SPDX-License-Identifier: Apache-2.0
// Sources: Thanarat Horprasert, David Harwood, Larry S. Davis, "A Statistical Approach for Real-time Robust Background
// Subtraction and Shadow Detection", IEEE ICCV Frame-Rate Workshop, 1999 (scaled plates).
#include "mattes/key_evidence.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/robust.h"

namespace fourdvt::mattes {
namespace {

constexpr float kTint = 0.08f;           // tolerance between a shadow's channels, as a share of the removed light
constexpr float kPerhapsShade = 0.25f;   // weight of possible scaled plate in the object's colours
constexpr float kPenumbra = 0.02f;       // unevenness of a shadow, as a share of the removed light
constexpr float kMaxUnderrated = 25;     // multiple of the noise's variance
constexpr float kMinNoiseLevels = 0.8f;  // levels: rounding and compression
constexpr int kWindow = 5, kWideWindow = 11;
// Mean squared deviations of 75 values: 1 ± 0.16 if the hypothesis holds.
constexpr float kLooksAlike = 1.5f, kLooksOther = 3.0f;
constexpr float kTextured = 1.5f;  // minimum variance of a neighbourhood whose agreement is evidence
constexpr float kUnknownColours = 0.15f, kUnknownRatios = 0.05f, kShadedShare = 0.5f, kOutliers = 1e-4f;
constexpr float kMinWidth = 0.01f, kWidthStep = 1.5f;  // resolution of ratioDensity, in deviations of a ratio

// Median of |x(i) - x(i + 1)| in one channel as a standard deviation of x, whose values are `spacing` apart.
float deviationOfNeighbours(const cv::Mat& x, int channel, float spacing) {
  std::vector<float> steps;
  steps.reserve(x.total());
  for (int r = 0; r < x.rows; ++r) {
    const auto* row = x.ptr<cv::Vec3f>(r);
    for (int c = 0; c + 1 < x.cols; ++c) steps.push_back(std::abs(row[c + 1][channel] - row[c][channel]));
  }
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + std::ptrdiff_t(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  // Quantised levels have many equal steps: the median is interpolated by the count below.
  const float value = *middle;
  size_t below = 0, equal = 0;
  for (const float s : steps) below += s < value - 1e-3f, equal += std::abs(s - value) <= 1e-3f;
  const float next = value - spacing / 2 + spacing * (float(steps.size()) / 2 - float(below)) / float(equal);
  return std::max(0.0f, next) / 0.6745f / std::sqrt(2.0f);
}

cv::Mat sumOfChannels(const cv::Mat& m) {
  cv::Mat out;
  cv::transform(m, out, cv::Matx13f(1, 1, 1));
  return out;
}

// Factor of a hypothesis per pixel, from the minimum mean squared deviation of the neighbourhoods that contain the
// pixel (at an outline, some neighbourhood lies on one side): 1 up to 3 standard deviations above its expected value,
// falling to e^-max_doubt at 15.
cv::Mat agreement(const cv::Mat& deviations, int window, double max_doubt) {
  cv::Mat out;
  cv::erode(deviations, out, cv::Mat::ones(window, window, CV_8U), {-1, -1}, 1, cv::BORDER_REPLICATE);
  const double sigma = std::sqrt(2.0 / (3 * window * window));
  out = cv::min(cv::max((out - (1 + 3 * sigma)) * (max_doubt / (12 * sigma)), 0.0), max_doubt);
  cv::exp(-out, out);
  return out;
}

cv::Mat windowMean(const cv::Mat& m, int window) {
  cv::Mat out;
  cv::blur(m, out, {window, window}, {-1, -1}, cv::BORDER_REPLICATE);
  return out;
}

}  // namespace

KeyEvidence::KeyEvidence(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options)
    : options_(options), plate_noise_(1.0f / float(background.plates)) {
  const cv::Size size(picture.width, picture.height);
  const cv::Mat bytes(size, CV_8UC3, const_cast<uint8_t*>(picture.pixels.data()));
  const cv::Mat mean(size, CV_32FC3, const_cast<float*>(background.mean.data()));
  const cv::Mat extra(size, CV_32F, const_cast<float*>(background.extra.data()));
  cv::Mat levels;
  bytes.convertTo(levels, CV_32F);
  measureNoise(levels, mean);
  const cv::Scalar scale(1 / noise_[0], 1 / noise_[1], 1 / noise_[2]);
  cv::multiply(levels + cv::Scalar::all(kToe), scale, picture_);
  cv::multiply(mean + cv::Scalar::all(kToe), scale, plate_);
  const float smallest = std::min({noise_[0], noise_[1], noise_[2]});
  extra_ = extra / (smallest * smallest);
  variance_ = extra_ + (1 + plate_noise_);
  if (!background.known.empty()) {
    known_ = cv::Mat(size, CV_8U);
    for (int i = 0; i < int(known_.total()); ++i) known_.at<uint8_t>(i) = background.known[size_t(i)] ? 255 : 0;
  }
  colours_.assign(size_t(kColours) * kColours * kColours, 0);
  ratios_.assign(size_t(kWidths) * kRatios, 1 / (options_.max_highlight - options_.min_shadow));
  lookAtNeighbourhoods();
}

void KeyEvidence::measureNoise(const cv::Mat& picture, const cv::Mat& mean) {
  const cv::Mat difference = picture - mean;
  for (int c = 0; c < 3; ++c)
    noise_[c] =
        std::max(kMinNoiseLevels, deviationOfNeighbours(difference, c, plate_noise_) / std::sqrt(1 + plate_noise_));
  // Compressed noise is correlated between neighbours: the median neighbourhood, which shows the plate, measures it.
  cv::Mat whitened;
  cv::multiply(difference, cv::Scalar(1 / noise_[0], 1 / noise_[1], 1 / noise_[2]), whitened);
  const cv::Mat squares = windowMean(sumOfChannels(whitened.mul(whitened)), kWindow) / (3 * (1 + plate_noise_));
  noise_ *= std::sqrt(
      std::clamp(median(std::vector<float>(squares.begin<float>(), squares.end<float>())), 1.0f, kMaxUnderrated));
}

// Least-squares scale of the plate for each neighbourhood. Channels may differ by the tint of a shadow.
KeyEvidence::Fit KeyEvidence::fit(int window) const {
  const cv::Mat pp = windowMean(sumOfChannels(picture_.mul(picture_)), window), spread = windowMean(extra_, window);
  const cv::Mat pb = windowMean(picture_.mul(plate_), window), bb = windowMean(plate_.mul(plate_), window);
  Fit out{cv::Mat(pp.size(), CV_32F), cv::Mat(pp.size(), CV_32F)};
  for (int i = 0; i < int(pp.total()); ++i) {
    const cv::Vec3f &cross = pb.at<cv::Vec3f>(i), &plate = bb.at<cv::Vec3f>(i);
    const float sum = cross[0] + cross[1] + cross[2], plate_sum = std::max(plate[0] + plate[1] + plate[2], 1e-6f);
    const float a = pp.at<float>(i), e = plate_noise_ + spread.at<float>(i);
    out.lit.at<float>(i) = (a - 2 * sum + plate_sum) / (3 * (1 + e));
    const float s = std::clamp(sum / plate_sum, options_.min_shadow, options_.max_highlight);
    const float tint = kTint * std::abs(1 - s);
    float scaled = a;
    for (int c = 0; c < 3; ++c) {
      const float channel = std::clamp(cross[c] / std::max(plate[c], 1e-6f), s - tint, s + tint);
      scaled += channel * (channel * plate[c] - 2 * cross[c]);
    }
    const float uneven = kPenumbra * (1 - s);
    out.scaled.at<float>(i) = scaled / (3 * (1 + s * s * e) + uneven * uneven * plate_sum);
  }
  return out;
}

void KeyEvidence::lookAtNeighbourhoods() {
  const Fit near = fit(kWindow), wide = fit(kWideWindow);
  const cv::Mat mean = windowMean(picture_, kWindow),
                square = windowMean(sumOfChannels(picture_.mul(picture_)), kWindow);
  const cv::Mat own = square - sumOfChannels(mean.mul(mean));
  object_ = near.scaled > kLooksOther;
  lit_ = near.lit < kLooksAlike;
  shaded_ = (near.lit > 2 * kLooksAlike) & (near.scaled < kLooksAlike) & (own > 3 * kTextured);
  lit_share_ = agreement(near.lit, kWindow, 4).mul(agreement(wide.lit, kWideWindow, 2));
  shaded_share_ = agreement(near.scaled, kWindow, 4).mul(agreement(wide.scaled, kWideWindow, 2));
  if (!known_.empty()) {  // unknown plate: no evidence
    lit_ &= known_;
    object_ &= known_;
    shaded_ &= known_;
  }
  learn(object_);
}

size_t KeyEvidence::colourBin(const cv::Vec3f& colour) const {
  size_t bin = 0;
  for (int c = 0; c < 3; ++c)
    bin = bin * kColours + size_t(std::clamp(int((colour[c] * noise_[c] - kToe) / 256 * kColours), 0, kColours - 1));
  return bin;
}

std::vector<float> KeyEvidence::counted(const cv::Mat& mask, bool unsure_counts_less) const {
  std::vector<float> counts(size_t(kColours) * kColours * kColours, 0);
  for (int i = 0; i < int(mask.total()); ++i)
    if (mask.at<uint8_t>(i))
      counts[colourBin(picture_.at<cv::Vec3f>(i))] +=
          !unsure_counts_less || object_.at<uint8_t>(i) ? 1.0f : kPerhapsShade;
  return counts;
}

// Density from a histogram, blurred by a bin and mixed with a uniform share.
std::vector<float> KeyEvidence::densityOf(std::vector<float> counts) const {
  double total = 0;
  for (const float count : counts) total += count;
  for (const size_t step : {size_t(1), size_t(kColours), size_t(kColours) * kColours}) {
    const std::vector<float> from = counts;
    for (size_t i = 0; i < counts.size(); ++i) {
      const size_t place = i / step % kColours;
      const float below = place > 0 ? from[i - step] : from[i], above = place + 1 < kColours ? from[i + step] : from[i];
      counts[i] = 0.25f * (below + 2 * from[i] + above);
    }
  }
  const float bin_volume = std::pow(256.0f / kColours, 3.0f) / (noise_[0] * noise_[1] * noise_[2]);
  const float everywhere = 1 / (bin_volume * float(counts.size()));
  for (float& count : counts) {
    const float seen = total > 0 ? count / float(total) / bin_volume : everywhere;
    count = kUnknownColours * everywhere + (1 - kUnknownColours) * seen;
  }
  return counts;
}

void KeyEvidence::learn(const cv::Mat& object) {
  colours_ = densityOf(counted(object, known_.empty()));
  if (!known_.empty()) others_ = densityOf(counted(object == 0, false));
  learnRatios(object);
}

void KeyEvidence::count(const cv::Mat& object, ColourCounts& counts) const {
  const auto add = [](std::vector<float>& to, const std::vector<float>& from) {
    to.resize(from.size(), 0);
    for (size_t i = 0; i < from.size(); ++i) to[i] += from[i];
  };
  add(counts.object, counted(object, known_.empty()));
  add(counts.background, counted(object == 0, false));
}

void KeyEvidence::use(const ColourCounts& counts) {
  colours_ = densityOf(counts.object);
  others_ = densityOf(counts.background);
}

void KeyEvidence::learnRatios(const cv::Mat& object) {
  // Ratios of shadows and highlights, each at the widths that noise gives them.
  const float low = options_.min_shadow, step = (options_.max_highlight - low) / kRatios;
  std::vector<double> histogram(kRatios, 0);
  for (int i = 0; i < int(object.total()); ++i) {
    if (!shaded_.at<uint8_t>(i) || object.at<uint8_t>(i)) continue;
    const cv::Vec3f &p = picture_.at<cv::Vec3f>(i), b = plate_.at<cv::Vec3f>(i);
    const float bb = std::max(b.dot(b), 1e-6f), s = p.dot(b) / bb;
    const int bin = int(std::floor((s - low) / step));
    // Dark plates give unreliable ratios.
    if (bin >= 0 && bin < kRatios) histogram[size_t(bin)] += std::min(1.0f, bb / 400);
  }
  double sum = 0;
  for (const double h : histogram) sum += h;
  for (int w = 0; w < kWidths; ++w) {
    const float width = kMinWidth * std::pow(kWidthStep, float(w));
    for (int r = 0; r < kRatios; ++r) {
      double density = 0;
      for (int k = 0; k < kRatios; ++k) {
        const float away = float(k - r) * step / width;
        density += histogram[size_t(k)] * std::exp(-0.5 * away * away);
      }
      density /= std::max(sum, 1.0) * width * 2.5066;
      ratios_[size_t(w * kRatios + r)] =
          kUnknownRatios / (step * kRatios) + (1 - kUnknownRatios) * (sum > 50 ? float(density) : 1 / (step * kRatios));
    }
  }
}

float KeyEvidence::ratioDensity(float ratio, float deviation) const {
  const float low = options_.min_shadow, step = (options_.max_highlight - low) / kRatios;
  const int r = int(std::floor((ratio - low) / step));
  const int w = std::clamp(int(std::lround(std::log(deviation / kMinWidth) / std::log(kWidthStep))), 0, kWidths - 1);
  if (r < -2 || r >= kRatios + 2) return 1e-4f;
  return ratios_[size_t(w * kRatios + std::clamp(r, 0, kRatios - 1))];
}

// Densities of the picture's colour at pixel i under the background hypotheses, three-dimensional, in units of noise.
KeyEvidence::Background KeyEvidence::backgroundAt(int i) const {
  const cv::Vec3f &p = picture_.at<cv::Vec3f>(i), b = plate_.at<cv::Vec3f>(i);
  if (!known_.empty() && !known_.at<uint8_t>(i)) return {others_[colourBin(p)], 0, 1};
  const cv::Vec3f off = p - b;
  const float v = variance_.at<float>(i), bb = std::max(b.dot(b), 1e-6f), length = std::sqrt(bb);
  Background out;
  out.lit =
      (1 - kShadedShare) * lit_share_.at<float>(i) * std::exp(-0.5f * off.dot(off) / v) / std::pow(6.2832f * v, 1.5f);
  out.ratio = p.dot(b) / bb;
  const cv::Vec3f across = p - out.ratio * b;
  const float s = std::clamp(out.ratio, options_.min_shadow, options_.max_highlight);
  const float tint = kTint * (1 - s), uneven = kPenumbra * (1 - s);
  const float vs = 1 + s * s * (v - 1) + (tint * tint + uneven * uneven) * bb / 3;
  out.shaded = kShadedShare * shaded_share_.at<float>(i) * std::exp(-0.5f * across.dot(across) / vs) / (6.2832f * vs) *
               ratioDensity(out.ratio, std::sqrt(vs) / length) / length;
  return out;
}

float KeyEvidence::objectDensity(const cv::Vec3f& colour) const { return colours_[colourBin(colour)]; }

cv::Mat KeyEvidence::cost() const {
  cv::Mat out(picture_.size(), CV_32F);
  for (int i = 0; i < int(out.total()); ++i) {
    const Background b = backgroundAt(i);
    const float object = objectDensity(picture_.at<cv::Vec3f>(i));
    out.at<float>(i) = std::log(b.lit + b.shaded + kOutliers * object) - std::log(object);
  }
  return out;
}

cv::Mat KeyEvidence::ratio() const {
  cv::Mat out(picture_.size(), CV_32F);
  for (int i = 0; i < int(out.total()); ++i) {
    const Background b = backgroundAt(i);
    out.at<float>(i) = b.lit >= b.shaded ? 1.0f : std::clamp(b.ratio, options_.min_shadow, options_.max_highlight);
  }
  return out;
}

}  // namespace fourdvt::mattes
