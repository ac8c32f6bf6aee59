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

// True if coverage at a sample's centre, interpolated between pixel centres, is inside.
bool insideAt(const Image& coverage, int sample_x, int sample_y) {
  const float x = (float(sample_x) + 0.5f) / kSamples - 0.5f, y = (float(sample_y) + 0.5f) / kSamples - 0.5f;
  const int left = int(std::floor(x)), top = int(std::floor(y));
  const float s = x - float(left), t = y - float(top);
  const auto at = [&](int u, int v) {
    return float(*coverage.at(std::clamp(u, 0, coverage.width - 1), std::clamp(v, 0, coverage.height - 1)));
  };
  return (at(left, top) * (1 - s) + at(left + 1, top) * s) * (1 - t) +
             (at(left, top + 1) * (1 - s) + at(left + 1, top + 1) * s) * t >
         127.5f;
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

double overlapOf(const FaceBuffer& drawn, const silhouette::Silhouette& silhouette) {
  size_t both = 0, either = 0;
  for (int y = 0; y < drawn.height; ++y)
    for (int x = 0; x < drawn.width; ++x) {
      const bool a = drawn.face[size_t(y) * drawn.width + x] != FaceBuffer::kNoFace,
                 b = insideAt(silhouette.coverage, x, y);
      both += a && b;
      either += a || b;
    }
  return either ? double(both) / double(either) : 1;
}

// Share of each pixel's samples covered by a face, 0 … 255.
Image coverageOf(const FaceBuffer& drawn, const PinholeCamera& camera) {
  Image out(camera.width, camera.height, 1);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      int hits = 0;
      for (int k = 0; k < kSamples * kSamples; ++k)
        hits += drawn.face[size_t(y * kSamples + k / kSamples) * drawn.width + x * kSamples + k % kSamples] !=
                FaceBuffer::kNoFace;
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

double outlineDistance_px(const FaceBuffer& drawn, const silhouette::Silhouette& silhouette) {
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
  return overlapOf(rasterise(silhouette.camera, surface.faces, surface.positions, kSamples), silhouette);
}

SilhouetteMatch silhouetteMatch(const silhouette::Silhouette& silhouette, const TriangleMesh& surface) {
  const FaceBuffer drawn = rasterise(silhouette.camera, surface.faces, surface.positions, kSamples);
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
