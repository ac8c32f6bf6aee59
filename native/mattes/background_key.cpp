// SPDX-License-Identifier: Apache-2.0
// Sources: Yuri Boykov, Marie-Pierre Jolly, "Interactive Graph Cuts for Optimal Boundary & Region Segmentation of
// Objects in N-D Images", IEEE International Conference on Computer Vision (ICCV), 2001 (energy). Jian Sun, Weiwei
// Zhang, Xiaoou Tang, Heung-Yeung Shum, "Background Cut", European Conference on Computer Vision (ECCV), 2006 (border
// costs). Carsten Rother, Vladimir Kolmogorov, Andrew Blake, "GrabCut: Interactive Foreground Extraction Using Iterated
// Graph Cuts", ACM Transactions on Graphics 23(3) (SIGGRAPH), 2004 (iterated colour models).
#include "mattes/background_key.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>
#include <vector>

namespace fourdvt::mattes {

cv::Mat cheapestCut(const CutCosts& costs, const cv::Mat& given, const cv::Mat& open) {
  cv::Mat node(open.size(), CV_32S, cv::Scalar(-1)), out = given.clone();
  const int count = cv::countNonZero(open);
  if (count == 0) return out;
  cv::detail::GCGraph<float> graph(static_cast<unsigned>(count), static_cast<unsigned>(8 * count));
  std::vector<float> balance;  // positive: towards the background
  balance.reserve(size_t(count));
  for (int y = 0; y < open.rows; ++y)
    for (int x = 0; x < open.cols; ++x)
      if (open.at<uint8_t>(y, x)) {
        node.at<int>(y, x) = graph.addVtx();
        balance.push_back(costs.object_minus_background.at<float>(y, x));
      }
  const auto edge = [&](int x, int y, int dx, int dy, const cv::Mat& weights) {
    if (x + dx < 0 || x + dx >= open.cols || y + dy >= open.rows) return;
    const int a = node.at<int>(y, x), b = node.at<int>(y + dy, x + dx);
    const float w = weights.at<float>(y, x);
    if (a >= 0 && b >= 0) graph.addEdges(a, b, w, w);
    if (a >= 0 && b < 0) balance[size_t(a)] += given.at<uint8_t>(y + dy, x + dx) ? -w : w;
    if (b >= 0 && a < 0) balance[size_t(b)] += given.at<uint8_t>(y, x) ? -w : w;
  };
  for (int y = 0; y < open.rows; ++y)
    for (int x = 0; x < open.cols; ++x) {
      edge(x, y, 1, 0, costs.right);
      edge(x, y, 0, 1, costs.down);
      edge(x, y, 1, 1, costs.down_right);
      edge(x, y, -1, 1, costs.down_left);
    }
  // Vertices on the source's side are object.
  for (int i = 0; i < count; ++i)
    graph.addTermWeights(i, std::max(0.0f, -balance[size_t(i)]), std::max(0.0f, balance[size_t(i)]));
  graph.maxFlow();
  for (int y = 0; y < open.rows; ++y)
    for (int x = 0; x < open.cols; ++x)
      if (node.at<int>(y, x) >= 0) out.at<uint8_t>(y, x) = graph.inSourceSegment(node.at<int>(y, x)) ? 255 : 0;
  return out;
}

namespace {

constexpr float kContrast = 5;       // units of noise: a step at which a border costs e^-½ of its price
constexpr int kMinSpeck = 12;        // pixels
constexpr float kMinPart = 0.01f;    // share of the largest part
constexpr float kMinBorder = 0.15f;  // minimum share of the border price

cv::Mat disc(int radius) { return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1}); }

// Contrast-sensitive border costs. An edge of the object must appear in the picture and in its difference to the plate.
cv::Mat borderCosts(const KeyEvidence& evidence, int dx, int dy, float price) {
  const cv::Mat &picture = evidence.picture(), &plate = evidence.plate();
  cv::Mat out(picture.size(), CV_32F, cv::Scalar(price));
  for (int y = 0; y + dy < picture.rows; ++y)
    for (int x = std::max(0, -dx); x + std::max(0, dx) < picture.cols; ++x) {
      const cv::Vec3f step = picture.at<cv::Vec3f>(y + dy, x + dx) - picture.at<cv::Vec3f>(y, x);
      const cv::Vec3f other = step - (plate.at<cv::Vec3f>(y + dy, x + dx) - plate.at<cv::Vec3f>(y, x));
      const bool known = evidence.known().empty() ||
                         (evidence.known().at<uint8_t>(y, x) != 0 && evidence.known().at<uint8_t>(y + dy, x + dx) != 0);
      // Expected squares of pure noise: 6 and 6 × (variance).
      const float here = step.dot(step) - 6, apart = other.dot(other) - 6 * evidence.variance().at<float>(y, x);
      const float seen = std::max(0.0f, known ? std::min(here, apart) : here);
      out.at<float>(y, x) = price * (kMinBorder + (1 - kMinBorder) * std::exp(-0.5f * seen / (kContrast * kContrast)));
    }
  return out;
}

// Removes parts of the object below `pixels` or below a share of the largest part, and fills holes below `pixels`.
void dropSpecks(cv::Mat& mask, int pixels) {
  for (int pass = 0; pass < 2; ++pass) {
    cv::Mat labels, stats, centres;
    const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, pass == 0 ? 8 : 4, CV_32S);
    int least = pixels;
    for (int label = 1; pass == 0 && label < count; ++label)
      least = std::max(least, int(kMinPart * float(stats.at<int>(label, cv::CC_STAT_AREA))));
    for (int i = 0; i < int(mask.total()); ++i) {
      const int label = labels.at<int>(i);
      if (label > 0 && label < count && stats.at<int>(label, cv::CC_STAT_AREA) < least) mask.at<uint8_t>(i) = 0;
    }
    cv::bitwise_not(mask, mask);
  }
}

// Mean of `values` (CV_32FC1 or C3) over the neighbours inside `mask`; `weight`: their count.
cv::Mat meanWhere(const cv::Mat& values, const cv::Mat& mask, cv::Mat& weight) {
  cv::Mat share, sum, masked = cv::Mat::zeros(values.size(), values.type());
  mask.convertTo(share, CV_32F, 1 / 255.0);
  values.copyTo(masked, mask);
  cv::GaussianBlur(masked, sum, {13, 13}, 2.2);
  cv::GaussianBlur(share, weight, {13, 13}, 2.2);
  for (int i = 0; i < int(sum.total()); ++i) {
    const float w = std::max(weight.at<float>(i), 1e-6f);
    if (values.channels() == 3)
      sum.at<cv::Vec3f>(i) /= w;
    else
      sum.at<float>(i) /= w;
  }
  return sum;
}

// Alpha within a pixel or two of the outline: the mixture of plate and object that matches the picture, combined with
// the blurred outline, which dominates where plate and object look alike.
Image softened(const KeyEvidence& evidence, const cv::Mat& mask, float blur_pixels) {
  constexpr float kShapeVariance = 0.03f, kTextureVariance = 4;
  cv::Mat inner, outer, beyond, shape, weight_object, weight_ratio;
  cv::erode(mask, inner, disc(1), {-1, -1}, 1, cv::BORDER_REPLICATE);
  cv::dilate(mask, outer, disc(1), {-1, -1}, 1, cv::BORDER_REPLICATE);
  cv::bitwise_not(outer, beyond);
  mask.convertTo(shape, CV_32F, 1 / 255.0);
  cv::GaussianBlur(shape, shape, {0, 0}, blur_pixels, 0, cv::BORDER_REPLICATE);
  const cv::Mat object = meanWhere(evidence.picture(), inner, weight_object);
  const cv::Mat ratio = meanWhere(evidence.ratio(), beyond, weight_ratio);
  Image out(mask.cols, mask.rows, 1);
  for (int i = 0; i < int(mask.total()); ++i) {
    out.pixels[size_t(i)] = mask.at<uint8_t>(i);
    if (inner.at<uint8_t>(i) || !outer.at<uint8_t>(i)) continue;
    float alpha = shape.at<float>(i);
    if (weight_object.at<float>(i) > 0.01f && weight_ratio.at<float>(i) > 0.01f) {
      const cv::Vec3f behind = ratio.at<float>(i) * evidence.plate().at<cv::Vec3f>(i);
      const cv::Vec3f step = object.at<cv::Vec3f>(i) - behind, seen = evidence.picture().at<cv::Vec3f>(i) - behind;
      const float contrast = std::max(step.dot(step), 1e-3f);
      const float mixed = std::clamp(seen.dot(step) / contrast, 0.0f, 1.0f);
      const float variance = (evidence.variance().at<float>(i) + kTextureVariance) / contrast;
      alpha = (alpha / kShapeVariance + mixed / variance) / (1 / kShapeVariance + 1 / variance);
    }
    out.pixels[size_t(i)] = static_cast<uint8_t>(std::lround(255 * std::clamp(alpha, 0.0f, 1.0f)));
  }
  return out;
}

}  // namespace

struct KeyCut::Parts {
  KeyEvidence evidence;
  BackgroundKeyOptions options;
  CutCosts borders;
  cv::Mat open;  // CV_8U: 0 where the label is fixed
};

KeyCut::KeyCut(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options)
    : parts_(new Parts{KeyEvidence(picture, background, options), options, {}, {}}) {
  assert(picture.channels == 3 && picture.width == background.width && picture.height == background.height);
  const KeyEvidence& evidence = parts_->evidence;
  parts_->borders = {{},
                     borderCosts(evidence, 1, 0, options.smoothness),
                     borderCosts(evidence, 0, 1, options.smoothness),
                     borderCosts(evidence, 1, 1, options.smoothness * 0.7071f),
                     borderCosts(evidence, -1, 1, options.smoothness * 0.7071f)};
  // Labels are fixed where wide surroundings look like the plate.
  cv::erode(evidence.surelyLit(), parts_->open, disc(3), {-1, -1}, 1, cv::BORDER_REPLICATE);
  cv::bitwise_not(parts_->open, parts_->open);
}
KeyCut::~KeyCut() = default;
KeyCut::KeyCut(KeyCut&&) noexcept = default;
KeyCut& KeyCut::operator=(KeyCut&&) noexcept = default;

cv::Mat KeyCut::cut(const cv::Mat& more_cost) const {
  CutCosts costs = parts_->borders;
  costs.object_minus_background = parts_->evidence.cost();
  cv::Mat open = parts_->open;
  if (!more_cost.empty()) {
    costs.object_minus_background += more_cost;
    open = open | (more_cost < 0);
  }
  return cheapestCut(costs, cv::Mat::zeros(open.size(), CV_8U), open);
}

cv::Mat KeyCut::cutNear(const cv::Mat& given, const cv::Mat& near, const cv::Mat& more_cost) const {
  CutCosts costs = parts_->borders;
  costs.object_minus_background = parts_->evidence.cost();
  if (!more_cost.empty()) costs.object_minus_background += more_cost;
  return cheapestCut(costs, given, near);
}

void KeyCut::learn(const cv::Mat& object) {
  cv::Mat inner;
  cv::erode(object, inner, disc(2));
  parts_->evidence.learn(inner);
}

void KeyCut::count(const cv::Mat& object, ColourCounts& counts) const { parts_->evidence.count(object, counts); }
void KeyCut::use(const ColourCounts& counts) { parts_->evidence.use(counts); }

Image KeyCut::matte(cv::Mat object) const {
  const BackgroundKeyOptions& o = parts_->options;
  object = object.clone();
  dropSpecks(object, std::max(kMinSpeck, int(std::lround(o.speck_share * float(object.total())))));
  return softened(parts_->evidence, object, o.blur_pixels);
}

Image backgroundKey(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options) {
  KeyCut key(picture, background, options);
  cv::Mat object = key.cut();
  for (int round = 1; round < options.rounds; ++round) {
    key.learn(object);
    object = key.cut();
  }
  return key.matte(object);
}

}  // namespace fourdvt::mattes
