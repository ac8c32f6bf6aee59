// SPDX-License-Identifier: Apache-2.0
#include "track/run/drawing.h"

#include <algorithm>
#include <cmath>

#include "base/face_buffer.h"
#include "report/picture_sheets.h"

namespace fourdvt::track {
namespace {

constexpr size_t kColumns = 8;  // cameras side by side
constexpr int kHeight = 360;    // pixels of one picture
constexpr glm::vec3 kPlain(0.85f), kHot(0.95f, 0.15f, 0.1f), kUnseen(0.35f, 0.45f, 0.8f);

bool onOutline(const cv::Mat& matte, int x, int y) {
  if (matte.at<uint8_t>(y, x) < 128) return false;
  for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
    const int u = x + dx, v = y + dy;
    if (u < 0 || v < 0 || u >= matte.cols || v >= matte.rows || matte.at<uint8_t>(v, u) < 128) return true;
  }
  return false;
}

Image greyPicture(const View& view) {
  Image out(view.camera.width, view.camera.height, 3);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int k = 0; k < 3; ++k) out.at(x, y)[k] = view.grey.at<uint8_t>(y, x);
  return out;
}

Image shadedMesh(const View& view, const std::vector<glm::uvec3>& faces, const Positions& positions,
                 std::span<const float> heat) {
  Image out(view.camera.width, view.camera.height, 3, 40);
  const FaceBuffer buffer = rasterise(view.camera, faces, positions, 1);
  const glm::vec3 centre(view.camera.centreInWorld());
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      uint8_t* pixel = out.at(x, y);
      if (const uint32_t face = buffer.face[size_t(y) * size_t(buffer.width) + size_t(x)];
          face != FaceBuffer::kNoFace) {
        const glm::uvec3& f = faces[face];
        const glm::vec3 normal = glm::cross(positions[f.y] - positions[f.x], positions[f.z] - positions[f.x]);
        const float length = glm::length(normal);
        const float light =
            length > 0 ? std::abs(glm::dot(normal / length, glm::normalize(centre - positions[f.x]))) : 0;
        glm::vec3 colour = kPlain;
        if (!heat.empty()) {
          const float value = (heat[f.x] + heat[f.y] + heat[f.z]) / 3;
          colour = value < 0 ? kUnseen : glm::mix(kPlain, kHot, std::min(value, 1.f));
        }
        for (int k = 0; k < 3; ++k) pixel[k] = uint8_t(255 * (0.15f + 0.85f * light) * colour[k]);
      }
      if (onOutline(view.matte, x, y)) pixel[0] = 0, pixel[1] = 220, pixel[2] = 0;
    }
  return out;
}

}  // namespace

Image trackedSheet(const std::string& title, const std::vector<View>& views, const std::vector<glm::uvec3>& faces,
                   const Positions& positions, std::span<const float> heat) {
  report::Sheet sheet;
  sheet.title = title;
  sheet.cells.resize(2);
  for (const View& view : views) {
    if (view.empty() || sheet.columns.size() == kColumns) continue;
    sheet.columns.push_back(view.camera.name);
    const int width = std::max(1, view.camera.width * kHeight / std::max(1, view.camera.height));
    sheet.cells[0].push_back(report::scaledTo(greyPicture(view), width, kHeight));
    sheet.cells[1].push_back(report::scaledTo(shadedMesh(view, faces, positions, heat), width, kHeight));
  }
  return report::drawSheet(sheet);
}

}  // namespace fourdvt::track
