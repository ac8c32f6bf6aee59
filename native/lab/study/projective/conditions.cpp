// SPDX-License-Identifier: Apache-2.0
#include "lab/study/projective/conditions.h"

#include <algorithm>
#include <cmath>

#include "lab/studio/random.h"
#include "lab/studio/rig.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr uint32_t kSeed = 14;

Condition proxied(const char* proxy) {
  Condition out;
  out.at = out.proxy = proxy;
  return out;
}

Condition onAxis(const char* axis, const char* at) {
  Condition out;
  out.axis = axis;
  out.at = at;
  out.all_methods = false;
  out.errors.seed = kSeed;
  return out;
}

Condition withError(const char* axis, const char* at, double studio::StudioKnobs::*knob) {
  Condition out = onAxis(axis, at);
  out.errors.*knob = std::stod(at);
  return out;
}

}  // namespace

std::string Condition::setting() const {
  return "axis=" + axis + " at=" + at + " proxy=" + proxy + " closest=" + std::to_string(closest);
}

std::string Condition::name() const { return axis + "-" + at; }

std::vector<Condition> proxyConditions(bool quick) {
  if (quick) return {proxied(kProxyGiven), proxied(kProxyHull)};
  std::vector<Condition> out;
  for (const char* proxy :
       {kProxyGiven, "given-2000", "given-500", kProxyRefined, kProxyHull, "hull-2px", "hull-4px", kProxyPlane})
    out.push_back(proxied(proxy));
  return out;
}

std::vector<Condition> cameraConditions(bool quick) {
  std::vector<Condition> out;
  for (const char* at : {"2", "3", "6", "8"}) {
    out.push_back(onAxis(kAxisCameras, at));
    out.back().closest = std::stoi(at);
    if (quick) break;
  }
  return out;
}

std::vector<Condition> calibrationConditions(bool quick) {
  using Knobs = studio::StudioKnobs;
  if (quick) return {withError(kAxisRotation, "0.1", &Knobs::rotation_deg)};
  std::vector<Condition> out;
  for (const char* at : {"0.05", "0.1", "0.2"}) out.push_back(withError(kAxisRotation, at, &Knobs::rotation_deg));
  for (const char* at : {"2", "5"}) out.push_back(withError(kAxisTranslation, at, &Knobs::translation_mm));
  out.push_back(withError(kAxisFocal, "0.2", &Knobs::focal_percent));
  for (const char* at : {"3", "6"}) out.push_back(withError(kAxisGain, at, &Knobs::gain_percent));
  for (const char* at : {"5", "15"}) out.push_back(withError(kAxisStandoff, at, &Knobs::proxy_mm));
  Condition mixed = onAxis(kAxisMixed, "1");
  mixed.errors.rotation_deg = 0.1, mixed.errors.translation_mm = 2;
  mixed.errors.focal_percent = 0.2, mixed.errors.gain_percent = 3, mixed.errors.proxy_mm = 5;
  out.push_back(mixed);
  return out;
}

const std::vector<std::string>& allMethods() {
  static const std::vector<std::string> methods{
      kMethodLinear,        kFvvr,           "lumigraph",          "filtered",
      "band-limited",       kMethodFloating, kMethodFloatingPairs, kMethodFloatingStatic,
      kMethodHoloportation, kMethodMontage,  kMethodSweep};
  return methods;
}

const std::vector<std::string>& axisMethods() {
  static const std::vector<std::string> methods{
      kMethodLinear, kFvvr, kMethodFloating, kMethodFloatingPairs, kMethodFloatingStatic, kMethodMontage, kMethodSweep};
  return methods;
}

std::vector<PinholeCamera> miscalibrated(const std::vector<PinholeCamera>& cameras, const Condition& condition) {
  const studio::StudioKnobs& e = condition.errors;
  if (e.rotation_deg == 0 && e.translation_mm == 0 && e.focal_percent == 0) return cameras;
  return studio::miscalibrated(cameras, e);
}

std::vector<Image> withGains(std::vector<Image> pictures, const Condition& condition) {
  const studio::StudioKnobs& e = condition.errors;
  if (e.gain_percent == 0) return pictures;
  for (size_t camera = 0; camera < pictures.size(); ++camera) {
    uint8_t levels[3][256];
    for (size_t c = 0; c < 3; ++c) {
      const double gain = 1 + 0.01 * e.gain_percent * studio::randomNormal(e.seed, 0x6a1e0000 + 4 * camera + c);
      for (int v = 0; v < 256; ++v) levels[c][v] = uint8_t(std::clamp(std::lround(gain * v), 0l, 255l));
    }
    std::vector<uint8_t>& pixels = pictures[camera].pixels;
    for (size_t i = 0; i < pixels.size(); i += 4)
      for (size_t c = 0; c < 3; ++c) pixels[i + c] = levels[c][pixels[i + c]];
  }
  return pictures;
}

}  // namespace fourdvt::study
