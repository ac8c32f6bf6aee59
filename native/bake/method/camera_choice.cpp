// SPDX-License-Identifier: Apache-2.0
#include "bake/method/camera_choice.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "base/text.h"

namespace fourdvt::bake {
namespace {

constexpr size_t kPoints = 500;  // points of the surface that are projected into each picture

// A camera's view of the surface.
struct Shown {
  size_t camera = 0;
  glm::dvec3 from{0};           // unit, from the surface's centre to the camera
  double share = 0;             // surface points inside the picture
  double pixels_per_metre = 0;  // at the surface's centre
  double worth = 0;             // weight of the view, 0 … 1
  double nearest_angle = 1e9;   // to a chosen camera, radians
};

std::vector<Shown> shownBy(const std::vector<PinholeCamera>& cameras, const Positions& surface) {
  const glm::dvec3 middle = boundsOf(surface).middle();
  const size_t step = std::max<size_t>(1, surface.size() / kPoints);
  std::vector<Shown> out;
  for (size_t c = 0; c < cameras.size(); ++c) {
    const PinholeCamera& camera = cameras[c];
    size_t inside = 0, asked = 0;
    for (size_t v = 0; v < surface.size(); v += step, ++asked) {
      const glm::dvec3 p = camera.project(glm::dvec3(surface[v]));
      inside += p.z > 0 && p.x >= 0 && p.y >= 0 && p.x < camera.width && p.y < camera.height;
    }
    const double depth = camera.project(middle).z;
    const glm::dvec3 to = camera.centreInWorld() - middle;
    if (inside == 0 || !(depth > 0) || !(glm::length(to) > 0)) continue;
    out.push_back({c, glm::normalize(to), double(inside) / double(asked), (camera.fx + camera.fy) / 2 / depth});
  }
  return out;
}

void judge(std::vector<Shown>& shown) {
  std::vector<double> fine;
  for (const Shown& s : shown) fine.push_back(s.pixels_per_metre);
  const double usual = median(std::move(fine));
  for (Shown& s : shown) s.worth = s.share * std::min(1.0, s.pixels_per_metre / usual);
}

}  // namespace

std::vector<size_t> chooseCameras(const std::vector<PinholeCamera>& cameras, const Positions& surface, size_t most) {
  std::vector<size_t> chosen;
  if (cameras.size() <= most) {
    for (size_t c = 0; c < cameras.size(); ++c) chosen.push_back(c);
    return chosen;
  }
  std::vector<Shown> left = surface.empty() ? std::vector<Shown>() : shownBy(cameras, surface);
  if (!left.empty()) judge(left);
  while (!left.empty() && chosen.size() < most) {
    const auto value = [&](const Shown& s) {
      return chosen.empty() ? s.share * s.pixels_per_metre : s.worth * s.nearest_angle;
    };
    const auto best =
        std::max_element(left.begin(), left.end(), [&](const Shown& a, const Shown& b) { return value(a) < value(b); });
    const glm::dvec3 from = best->from;
    chosen.push_back(best->camera);
    left.erase(best);
    for (Shown& s : left)
      s.nearest_angle = std::min(s.nearest_angle, std::acos(std::clamp(glm::dot(s.from, from), -1.0, 1.0)));
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

Result<std::vector<size_t>> camerasByName(const std::vector<PinholeCamera>& cameras,
                                          const std::vector<std::string>& names) {
  std::vector<size_t> out;
  for (const std::string& name : names) {
    const auto found = std::find_if(cameras.begin(), cameras.end(), [&](const auto& c) { return c.name == name; });
    if (found != cameras.end()) {
      out.push_back(size_t(found - cameras.begin()));
      continue;
    }
    const std::string known = joined(cameras, ", ", &PinholeCamera::name);
    return Error{ErrorId::InvalidArgument, "--cameras: there is no camera \"" + name + "\"; the capture has " + known};
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace fourdvt::bake
