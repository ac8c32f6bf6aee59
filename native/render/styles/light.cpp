// SPDX-License-Identifier: Apache-2.0
#include "render/styles/light.h"

#include <cmath>

namespace fourdvt::render {
namespace {

constexpr double kPi = 3.14159265358979323846;
// Clamped-cosine factors of orders 0, 1 and 2, relative to the first.
constexpr float kCosine[9] = {1, 2 / 3.0f, 2 / 3.0f, 2 / 3.0f, 0.25f, 0.25f, 0.25f, 0.25f, 0.25f};

// Real spherical harmonics, orthonormal on the sphere.
std::array<float, 9> harmonics(const glm::vec3& d) {
  return {0.282095f,
          0.488603f * d.y,
          0.488603f * d.z,
          0.488603f * d.x,
          1.092548f * d.x * d.y,
          1.092548f * d.y * d.z,
          0.315392f * (3 * d.z * d.z - 1),
          1.092548f * d.x * d.z,
          0.546274f * (d.x * d.x - d.y * d.y)};
}

void addLight(Light& light, const glm::vec3& direction, const glm::vec3& color, float solid_angle) {
  const auto basis = harmonics(direction);
  for (size_t i = 0; i < light.size(); ++i) light[i] += kCosine[i] * basis[i] * solid_angle * color;
}

}  // namespace

glm::vec3 lightAt(const Light& light, const glm::vec3& direction) {
  const auto basis = harmonics(direction);
  glm::vec3 sum(0);
  for (size_t i = 0; i < light.size(); ++i) sum += basis[i] * light[i];
  return sum;
}

Result<Light> lightFromPicture(std::span<const uint8_t> pixels, int width, int height, int channels) {
  if (width < 2 || height < 1 || std::abs(width - 2 * height) > 1 || channels < 3 || channels > 4 ||
      pixels.size() < size_t(width) * size_t(height) * size_t(channels))
    return Error{ErrorId::InvalidArgument, "a light must be an equirectangular picture, twice as wide as it is high"};
  Light light{};
  for (int y = 0; y < height; ++y) {
    const double top = kPi * (0.5 - double(y) / height), bottom = kPi * (0.5 - (y + 1.0) / height);
    const double elevation = (top + bottom) / 2;
    const auto solid_angle = float(2 * kPi / width * (std::sin(top) - std::sin(bottom)));
    for (int x = 0; x < width; ++x) {
      const double turn = 2 * kPi * ((x + 0.5) / width - 0.5);
      const uint8_t* p = &pixels[(size_t(y) * size_t(width) + size_t(x)) * size_t(channels)];
      addLight(light,
               {float(std::cos(elevation) * std::sin(turn)), float(std::sin(elevation)),
                float(-std::cos(elevation) * std::cos(turn))},
               glm::vec3(p[0], p[1], p[2]) / 255.0f, solid_angle);
    }
  }
  return light;
}

Light studioLight() {
  Light light{};
  light[0] = glm::vec3(0.36f) / 0.282095f;  // even light of this colour
  addLight(light, glm::normalize(glm::vec3(-0.6f, 0.7f, 0.6f)), {1.0f, 0.86f, 0.68f}, 2.4f);
  addLight(light, glm::normalize(glm::vec3(0.8f, 0.2f, -0.6f)), {0.35f, 0.55f, 1.0f}, 1.8f);
  return light;
}

}  // namespace fourdvt::render
