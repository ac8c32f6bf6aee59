// SPDX-License-Identifier: Apache-2.0
// Expected results of the layered pass, computed in double precision for surfaces in the plane z = 0 that face +Z.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "quad_scene.h"

namespace fourdvt::testing {

constexpr double kTolerance = 2.0;  // levels of 255

inline render::RecipeOptions plainOptions() {
  render::RecipeOptions options;
  options.ground_shadow = false;
  options.samples = 0;
  return options;
}

// Layers of one constant colour each, side by side.
inline Image constantLayers(const Scene& scene, const std::vector<glm::dvec3>& colors) {
  Image image(scene.rendition.width, scene.rendition.height, 4, 255);
  for (size_t layer = 0; layer < colors.size(); ++layer) {
    const package::Rect& rect = scene.rendition.layers[layer];
    for (int y = rect.y; y < rect.y + rect.height; ++y)
      for (int x = rect.x; x < rect.x + rect.width; ++x)
        for (int c = 0; c < 3; ++c) image.at(x, y)[c] = static_cast<uint8_t>(colors[layer][c]);
  }
  return image;
}

// Intersection of the ray through the centre of pixel (x, y) with the plane z = 0.
inline glm::dvec3 pointOnPlane(const PinholeCamera& camera, int x, int y) {
  const glm::dvec3 ray_in_cam((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
  const glm::dvec3 ray = glm::transpose(glm::dmat3(camera.cam_from_world)) * ray_in_cam;
  const glm::dvec3 eye = camera.centreInWorld();
  return eye - ray * (eye.z / ray.z);
}

// LVDT Eq. 3 with the corrected sign, for the normal +Z, with the options' exponents.
inline double eq3(const PinholeCamera& camera, const PinholeCamera& view, const glm::dvec3& point,
                  const render::RecipeOptions& options) {
  const glm::dvec3 d = glm::normalize(camera.centreInWorld() - point);
  const glm::dvec3 v = glm::normalize(view.centreInWorld() - point);
  return std::pow(std::max(d.z, 0.0), options.facing_exponent) *
         std::pow(std::max(glm::dot(d, v), 0.0), options.view_exponent);
}

inline void expectColor(const Image& picture, int x, int y, const glm::dvec3& expected, double tolerance) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(picture.at(x, y)[c], expected[c], tolerance) << x << "," << y << " channel " << c;
  EXPECT_EQ(picture.at(x, y)[3], 255);
}

}  // namespace fourdvt::testing
