// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "lab/studio/random.h"

namespace fourdvt::studio {
namespace {

constexpr double kGreen[3] = {46, 168, 82};

constexpr uint64_t kFirstPlateShot = 0x80000000;  // above all frames' shots

uint8_t level(double value) { return static_cast<uint8_t>(std::clamp(std::lround(value), 0l, 255l)); }

Image greenBackdrop(int camera, int width, int height) {
  Image out(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double light = 1.04 - 0.12 * y / height + 0.05 * std::cos(3.0 * x / width + camera);
      for (int c = 0; c < 3; ++c) out.at(x, y)[c] = level(kGreen[c] * light);
    }
  return out;
}

// Sine, -1…1, spanning half a turn to a whole one over time 0…1, with a random start.
double wave(uint32_t seed, uint64_t key, double time) {
  const auto share = [&](uint64_t k) { return double(randomBits(seed, key + k) >> 11) / double(1ull << 53); };
  return std::sin(2 * std::numbers::pi * (share(0) + (0.5 + 0.5 * share(1)) * time));
}

}  // namespace

Sensor::Sensor(const StudioKnobs& knobs, int camera, int width, int height)
    : Sensor(knobs, camera, greenBackdrop(camera, width, height)) {}

Sensor::Sensor(const StudioKnobs& knobs, int camera, Image backdrop)
    : knobs_(knobs), camera_(camera), backdrop_(std::move(backdrop)), plate_(backdrop_) {
  for (int c = 0; c < 3; ++c)
    gain_[c] = 1 + 0.01 * knobs.gain_percent * randomNormal(knobs.seed, 0x6a1e0000 + 4 * camera + c);
  for (size_t i = 0; i < plate_.pixels.size(); ++i) plate_.pixels[i] = level(gain_[i % 3] * backdrop_.pixels[i]);
}

Image Sensor::recordedPlate(uint32_t take, const Image* backdrop) const {
  return expose(Image(plate_.width, plate_.height, 4), kFirstPlateShot + take, backdrop);
}

glm::dvec3 Sensor::drift(size_t clip, double time) const {
  const uint64_t key = 0xd21f0000 + 4096 * clip + 4 * uint64_t(camera_);
  const double exposure = 1 + 0.01 * knobs_.exposure_drift_percent * wave(knobs_.seed, key, time);
  const double warmth = 0.01 * knobs_.white_balance_drift_percent * wave(knobs_.seed, key + 2, time);
  return exposure * glm::dvec3(1 + warmth, 1, 1 - warmth);
}

Image Sensor::expose(const Image& picture, uint64_t shot, const Image* backdrop, const glm::dvec3& drift) const {
  const Image& background = backdrop ? *backdrop : backdrop_;
  Image out(picture.width, picture.height, 3);
  const uint64_t stream = (uint64_t(camera_) << 32) + shot;
  for (size_t i = 0; i < size_t(out.width) * out.height; ++i) {
    const double behind = (255 - picture.pixels[4 * i + 3]) / 255.0;
    for (int c = 0; c < 3; ++c) {
      const double noise =
          knobs_.noise_levels > 0 ? knobs_.noise_levels * randomNormal(knobs_.seed + stream, 3 * i + c) : 0;
      out.pixels[3 * i + c] =
          level(gain_[c] * drift[c] * (picture.pixels[4 * i + c] + behind * background.pixels[3 * i + c]) + noise);
    }
  }
  return out;
}

Image Sensor::matte(const Image& picture) const {
  Image out(picture.width, picture.height, 1);
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = picture.pixels[4 * i + 3];
  const int radius = static_cast<int>(std::lround(knobs_.erosion_pixels));
  if (radius == 0) return out;
  Image eroded(picture.width, picture.height, 1);
  const cv::Mat in(out.height, out.width, CV_8U, out.pixels.data());
  cv::Mat result(out.height, out.width, CV_8U, eroded.pixels.data());
  cv::erode(in, result, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1}));
  return eroded;
}

}  // namespace fourdvt::studio
