// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/silhouette_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/face_buffer.h"
#include "base/robust.h"
#include "report/picture_sheets.h"
#include "silhouette/silhouette.h"

namespace fourdvt::reconstruct {
namespace {

constexpr int kSamples = 2, kMargin = 12;

// Samples of a camera's picture, row by row: 1 or 0.
using Samples = std::vector<uint8_t>;

// Two pixels beside a sample, and the second one's weight in steps of 1 / kWeights; the picture ends with its pixels.
constexpr int kWeights = 2 * kSamples;
struct Between {
  int first, second, weight;
  Between(int sample, int pixels) {
    const int place = 2 * sample + 1 + kSamples;  // from one pixel before the first one's centre
    weight = place % kWeights;
    first = std::max(place / kWeights - 1, 0), second = std::min(place / kWeights, pixels - 1);
  }
};

// Samples at which coverage, interpolated between pixel centres, is inside.
Samples samplesInside(const Image& coverage) {
  std::vector<Between> columns;
  for (int x = 0; x < coverage.width * kSamples; ++x) columns.emplace_back(x, coverage.width);
  std::vector<int> across(coverage.width);  // a row of pixels at the samples' height, times kWeights
  Samples out;
  out.reserve(columns.size() * coverage.height * kSamples);
  for (int y = 0; y < coverage.height * kSamples; ++y) {
    const Between row(y, coverage.height);
    const uint8_t *above = coverage.at(0, row.first), *below = coverage.at(0, row.second);
    for (int x = 0; x < coverage.width; ++x) across[x] = above[x] * (kWeights - row.weight) + below[x] * row.weight;
    for (const Between& c : columns) {
      const int sum = across[c.first] * (kWeights - c.weight) + across[c.second] * c.weight;
      out.push_back(2 * sum > 255 * kWeights * kWeights);
    }
  }
  return out;
}

Samples samplesOf(const TriangleMesh& surface, const PinholeCamera& camera) {
  return coveredSamples(camera, surface.faces, surface.positions, kSamples);
}

std::array<uint8_t, 3> shade(const PinholeCamera& camera, const TriangleMesh& surface, uint32_t face) {
  const glm::uvec3 f = surface.faces[face];
  const glm::dvec3 a(surface.positions[f.x]), b(surface.positions[f.y]), c(surface.positions[f.z]);
  const glm::dvec3 across = glm::cross(b - a, c - a);
  const double length = glm::length(across);
  if (!(length > 0)) return {128, 128, 128};
  const glm::dvec3 in_cam = glm::dmat3(camera.cam_from_world) * (across / length);
  const double light = std::max(0.0, glm::dot(in_cam, glm::normalize(glm::dvec3(-0.35, -0.5, -0.8))));
  const auto grey = uint8_t(50 + 190 * light);
  return {grey, grey, uint8_t(std::min(255, grey + 12))};
}

}  // namespace

namespace {

double overlapOf(const Samples& drawn, const silhouette::Silhouette& silhouette) {
  const Samples inside = samplesInside(silhouette.coverage);
  size_t both = 0, either = 0;
  for (size_t i = 0; i < drawn.size(); ++i) both += drawn[i] & inside[i], either += drawn[i] | inside[i];
  return either ? double(both) / double(either) : 1;
}

// Share of each pixel's samples covered by a face, 0 … 255.
Image coverageOf(const Samples& drawn, const PinholeCamera& camera) {
  Image out(camera.width, camera.height, 1);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      int hits = 0;
      for (int k = 0; k < kSamples * kSamples; ++k)
        hits += drawn[size_t(y * kSamples + k / kSamples) * (out.width * kSamples) + x * kSamples + k % kSamples];
      *out.at(x, y) = uint8_t(255 * hits / (kSamples * kSamples));
    }
  return out;
}

// Calls `place` for every crossing of coverage 127.5 between two pixel centres of a row or column, in pixels.
template <class Place>
void alongOutline(const Image& coverage, const Place& place) {
  for (int y = 0; y < coverage.height; ++y)
    for (int x = 0; x < coverage.width; ++x)
      for (int down = 0; down < 2; ++down) {
        if (x + 1 - down >= coverage.width || y + down >= coverage.height) continue;
        const float here = *coverage.at(x, y), there = *coverage.at(x + 1 - down, y + down);
        if ((here > 127.5f) == (there > 127.5f)) continue;
        const float share = (127.5f - here) / (there - here);
        place(x + 0.5f + (down ? 0 : share), y + 0.5f + (down ? share : 0));
      }
}

double outlineDistance_px(const Samples& drawn, const silhouette::Silhouette& silhouette) {
  const silhouette::SilhouetteDistance surface(coverageOf(drawn, silhouette.camera));
  std::vector<float> beside;
  if (!surface.empty() && !surface.full())
    alongOutline(silhouette.coverage, [&](float x, float y) { beside.push_back(std::abs(surface.at(x, y))); });
  return median(std::move(beside), std::numeric_limits<float>::quiet_NaN());
}

// Depth of the surface minus that of the hull, along the optical axis; infinite without surface, NaN without hull.
std::vector<float> depthBehindHull(const PinholeCamera& camera, const TriangleMesh& hull, const TriangleMesh& surface) {
  const FaceBuffer before = rasterise(camera, hull.faces, hull.positions, 1),
                   after = rasterise(camera, surface.faces, surface.positions, 1);
  std::vector<float> out(before.face.size(), std::numeric_limits<float>::quiet_NaN());
  for (size_t i = 0; i < out.size(); ++i)
    if (before.face[i] != FaceBuffer::kNoFace) out[i] = after.depth_m[i] - before.depth_m[i];
  return out;
}

}  // namespace

double silhouetteOverlap(const silhouette::Silhouette& silhouette, const TriangleMesh& surface) {
  return overlapOf(samplesOf(surface, silhouette.camera), silhouette);
}

SilhouetteMatch silhouetteMatch(const silhouette::Silhouette& silhouette, const TriangleMesh& surface) {
  const Samples drawn = samplesOf(surface, silhouette.camera);
  return {overlapOf(drawn, silhouette), outlineDistance_px(drawn, silhouette)};
}

double movedShare(const PinholeCamera& camera, const TriangleMesh& hull, const TriangleMesh& surface, double min_m) {
  size_t moved = 0, all = 0;
  for (const float deeper_m : depthBehindHull(camera, hull, surface)) {
    if (std::isnan(deeper_m)) continue;
    ++all, moved += deeper_m >= min_m;
  }
  return all ? double(moved) / double(all) : 0;
}

Image movedPicture(const PinholeCamera& camera, const Image& rgba, const TriangleMesh& hull,
                   const TriangleMesh& surface, double max_m) {
  const std::vector<float> behind = depthBehindHull(camera, hull, surface);
  Image out(rgba.width, rgba.height, 3, 24);
  for (size_t i = 0; i < behind.size(); ++i) {
    if (!std::isfinite(behind[i])) continue;
    const double share = std::clamp(behind[i] / max_m, 0.0, 1.0);
    uint8_t* to = out.pixels.data() + 3 * i;
    to[0] = uint8_t(150 + 90 * share), to[1] = to[2] = uint8_t(150 - 110 * share);
  }
  const auto box = report::shownBox(rgba, kMargin);
  return report::cropped(out, box[0], box[1], box[2], box[3]);
}

SurfacePictures surfacePictures(const silhouette::Silhouette& silhouette, const Image& rgba,
                                const TriangleMesh& surface) {
  const auto drawn = rasterise(silhouette.camera, surface.faces, surface.positions, 1);
  const auto hit = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < drawn.width && y < drawn.height &&
           drawn.face[size_t(y) * drawn.width + x] != FaceBuffer::kNoFace;
  };
  const auto matte = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < rgba.width && y<rgba.height&& * silhouette.coverage.at(x, y)> 127;
  };
  const auto edge = [](const auto& in, int x, int y) {
    return in(x, y) && !(in(x - 1, y) && in(x + 1, y) && in(x, y - 1) && in(x, y + 1));
  };
  SurfacePictures out{Image(rgba.width, rgba.height, 3), Image(rgba.width, rgba.height, 3, 24)};
  for (int y = 0; y < rgba.height; ++y)
    for (int x = 0; x < rgba.width; ++x) {
      const uint8_t* from = rgba.at(x, y);
      uint8_t* to = out.over_picture.at(x, y);
      for (int k = 0; k < 3; ++k) to[k] = uint8_t(from[k] * (matte(x, y) ? 0.8 : 0.45));
      if (edge(hit, x, y)) {
        to[0] = 40, to[1] = 230, to[2] = 70;
      } else if (edge(matte, x, y)) {
        to[0] = 250, to[1] = 60, to[2] = 50;
      }
      if (!hit(x, y)) continue;
      const auto colour = shade(silhouette.camera, surface, drawn.face[size_t(y) * drawn.width + x]);
      std::copy(colour.begin(), colour.end(), out.shaded.at(x, y));
    }
  const auto box = report::shownBox(rgba, kMargin);
  out.over_picture = report::cropped(out.over_picture, box[0], box[1], box[2], box[3]);
  out.shaded = report::cropped(out.shaded, box[0], box[1], box[2], box[3]);
  return out;
}

}  // namespace fourdvt::reconstruct
