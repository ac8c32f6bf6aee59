// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/bystander.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fourdvt::studio {
namespace {

constexpr double kBehindRing = 1.12;  // distance from the middle as a multiple of the cameras'
constexpr double kAside_deg = 14;     // from the position opposite to the best-placed camera
constexpr double kHeight = 0.92, kDarker = 0.85;
constexpr double kSway_m = 0.12, kSway_s = 4.5;

// Permutes red, green and blue.
Image recoloured(const Image& rgb) {
  Image out = rgb;
  for (size_t i = 0; i + 2 < out.pixels.size(); i += 3)
    for (size_t c = 0; c < 3; ++c) out.pixels[i + c] = static_cast<uint8_t>(kDarker * rgb.pixels[i + (c + 1) % 3]);
  return out;
}

}  // namespace

Result<std::unique_ptr<Bystander>> Bystander::create(gpu::Device& device, const Rig& rig, double ground_y_m,
                                                     uint32_t seed, const PinholeCamera& drawn) {
  std::unique_ptr<Bystander> out(new Bystander());
  FOURDVT_ASSIGN(out->actor_, createProceduralActor({"walk"}, 0.045));
  FOURDVT_ASSIGN(auto renderer, Renderer::create(device, out->actor_->surface(), recoloured(out->actor_->texture()),
                                                 drawn.width, drawn.height));
  out->renderer_ = std::make_unique<Renderer>(std::move(renderer));
  const glm::dvec3 eye = rig.ring[seed % rig.ring.size()].centreInWorld();
  const double azimuth = std::atan2(eye.x, eye.z) + (180 + kAside_deg) * std::numbers::pi / 180;
  const glm::dvec3 outwards(std::sin(azimuth), 0, std::cos(azimuth));
  out->place_ = kBehindRing * std::hypot(eye.x, eye.z) * outwards + glm::dvec3(0, ground_y_m, 0);
  out->sideways_ = {outwards.z, 0, -outwards.x};
  out->near_m_ = rig.near_m;
  out->far_m_ = rig.far_m;
  return out;
}

void Bystander::pose(double time_s) {
  const double phase = time_s / actor_->motions()[0].duration_s, turn = 2 * std::numbers::pi * time_s / kSway_s;
  actor_->pose(std::vector<double>{1}, phase - std::floor(phase), positions_);
  const glm::dvec3 at = place_ + kSway_m * std::sin(turn) * sideways_, forward = sideways_;
  const glm::dvec3 left = glm::cross(glm::dvec3(0, 1, 0), forward);
  for (glm::vec3& p : positions_) {
    const glm::dvec3 body = kHeight * glm::dvec3(p);
    p = glm::vec3(at + body.x * left + glm::dvec3(0, body.y, 0) + body.z * forward);
  }
  renderer_->setPose(positions_, 0, phase - std::floor(phase));
}

Result<Image> Bystander::draw(const PinholeCamera& camera) {
  return renderer_->draw(camera, near_m_, far_m_, {.shading = 0.5f});
}

Image composed(const Image& over, const Image& behind) {
  Image out = behind;
  for (size_t i = 0; i < out.pixels.size(); ++i) {
    const uint8_t* rgba = &over.pixels[i / 3 * 4];
    out.pixels[i] = static_cast<uint8_t>(std::min(255, rgba[i % 3] + (behind.pixels[i] * (255 - rgba[3]) + 127) / 255));
  }
  return out;
}

}  // namespace fourdvt::studio
