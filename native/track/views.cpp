// SPDX-License-Identifier: Apache-2.0
#include "track/views.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "base/face_buffer.h"
#include "base/opencv_image.h"
#include "base/parallel.h"
#include "base/robust.h"

namespace fourdvt::track {
namespace {

constexpr uint8_t kBackground = 128;      // grey that hides what is not the performer
constexpr int kStructureSide = 9;         // pixels of the structure tensor's window
constexpr float kDepthMargin_m = 0.015f;  // tolerance of the visibility test

bool sees(const FaceBuffer& buffer, const glm::dvec3& projected) {
  const int x = int(std::floor(projected.x)), y = int(std::floor(projected.y));
  if (projected.z <= 0 || x < 0 || y < 0 || x >= buffer.width || y >= buffer.height) return false;
  const float depth = buffer.depth_m[size_t(y) * size_t(buffer.width) + size_t(x)];
  return std::isfinite(depth) && float(projected.z) < depth + kDepthMargin_m;
}

float sample(const cv::Mat& grey, double x, double y) {
  const double u = x - 0.5, v = y - 0.5;
  const int x0 = int(std::floor(u)), y0 = int(std::floor(v));
  if (x0 < 0 || y0 < 0 || x0 + 1 >= grey.cols || y0 + 1 >= grey.rows) return -1;
  const double a = u - x0, b = v - y0;
  const uint8_t *r0 = grey.ptr(y0) + x0, *r1 = grey.ptr(y0 + 1) + x0;
  return float((1 - b) * ((1 - a) * r0[0] + a * r0[1]) + b * ((1 - a) * r1[0] + a * r1[1]));
}

// Appearance of the source picture on the mesh in another pose. `known`: 255 where the source sees the surface.
struct Synthesis {
  cv::Mat grey, known;
};
Synthesis synthesise(const View& source, const FaceBuffer& source_buffer, const Positions& source_positions,
                     const View& target, const FaceBuffer& target_buffer, const Positions& positions,
                     std::span<const glm::uvec3> faces) {
  Synthesis out{target.grey.clone(), cv::Mat::zeros(target.grey.size(), CV_8UC1)};
  ProjectedFace projected;
  uint32_t held = FaceBuffer::kNoFace;
  glm::dvec3 corners[3];
  for (int y = 0; y < target_buffer.height; ++y)
    for (int x = 0; x < target_buffer.width; ++x) {
      const uint32_t face = target_buffer.face[size_t(y) * size_t(target_buffer.width) + size_t(x)];
      if (face == FaceBuffer::kNoFace) {
        out.grey.at<uint8_t>(y, x) = kBackground;
        continue;
      }
      if (face != held) {
        held = face;
        if (!projectFace(target.camera, faces[face], positions, 1, projected)) held = FaceBuffer::kNoFace;
        for (int k = 0; k < 3; ++k) corners[k] = source_positions[faces[face][k]];
      }
      double w[3];
      if (held == FaceBuffer::kNoFace || !projected.barycentric({x + 0.5, y + 0.5}, w)) continue;
      // Perspective-correct weights.
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += w[k] *= projected.inverse_depth[k];
      const glm::dvec3 at = source.camera.project((w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2]) / sum);
      if (!sees(source_buffer, at)) continue;
      const float value = sample(source.grey, at.x, at.y);
      if (value < 0) continue;
      out.grey.at<uint8_t>(y, x) = uint8_t(value + 0.5f);
      out.known.at<uint8_t>(y, x) = 255;
    }
  return out;
}

cv::Mat flowOf(const cv::Mat& from, const cv::Mat& to) {
  cv::Mat flow;
  const auto dis = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_FAST);
  dis->setFinestScale(1);  // instead of the preset's 2: halves the error at the edges of hands
  dis->calc(from, to, flow);
  return flow;
}

cv::Vec2f flowAt(const cv::Mat& flow, double x, double y) {
  const int column = std::clamp(int(std::floor(x)), 0, flow.cols - 1),
            row = std::clamp(int(std::floor(y)), 0, flow.rows - 1);
  return flow.at<cv::Vec2f>(row, column);
}

// Structure tensor of a picture: xx, xy, yy, squared levels per pixel².
cv::Mat structureOf(const cv::Mat& grey) {
  cv::Mat x, y, products[3], out;
  cv::Sobel(grey, x, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(grey, y, CV_32F, 0, 1, 3, 1.0 / 8);
  products[0] = x.mul(x), products[1] = x.mul(y), products[2] = y.mul(y);
  cv::merge(products, 3, out);
  cv::blur(out, out, {kStructureSide, kStructureSide});
  return out;
}

// Share of a match's weight by direction: T (T + n²)⁻¹ for the structure tensor T, 0 along edges and where nothing is
// drawn, 1 across strong edges.
glm::dmat2 certaintyOf(const cv::Vec3f& tensor, double noise) {
  const glm::dmat2 structure(tensor[0], tensor[1], tensor[1], tensor[2]);
  return structure * glm::inverse(structure + glm::dmat2(noise * noise));
}

std::vector<PixelMatch> matchesOf(std::span<const glm::uvec3> faces, const View& source,
                                  const Positions& source_positions, const View& target, const Positions& positions,
                                  std::span<const glm::vec3> normals, const FlowMatchOptions& options) {
  std::vector<PixelMatch> out;
  const std::vector<glm::uvec3> list(faces.begin(), faces.end());
  const FaceBuffer source_buffer = rasterise(source.camera, list, source_positions, 1);
  const FaceBuffer buffer = rasterise(target.camera, list, positions, 1);
  const Synthesis seen = synthesise(source, source_buffer, source_positions, target, buffer, positions, faces);
  const cv::Mat forward = flowOf(seen.grey, target.grey), backward = flowOf(target.grey, seen.grey);
  const cv::Mat structure = structureOf(target.grey);
  const glm::dvec3 centre = target.camera.centreInWorld();
  for (uint32_t v = 0; v < positions.size(); ++v) {
    const glm::dvec3 position = positions[v];
    const double cosine = glm::dot(glm::normalize(centre - position), glm::dvec3(normals[v]));
    if (cosine < options.min_cosine) continue;
    const glm::dvec3 at = target.camera.project(position);
    if (!sees(buffer, at)) continue;
    const int x = int(std::floor(at.x)), y = int(std::floor(at.y));
    if (!seen.known.at<uint8_t>(y, x)) continue;
    const cv::Vec2f f = flowAt(forward, at.x, at.y);
    const double to_x = at.x + f[0], to_y = at.y + f[1];
    if (to_x < 0 || to_y < 0 || to_x >= target.grey.cols || to_y >= target.grey.rows) continue;
    if (target.matte.at<uint8_t>(int(to_y), int(to_x)) < 128) continue;
    const cv::Vec2f b = flowAt(backward, to_x, to_y);
    const double error = std::hypot(f[0] + b[0], f[1] + b[1]);
    if (error > options.consistency_px) continue;
    const double trust = 1 - error / options.consistency_px;
    const double sigma_px = options.sigma_px * options.reduction;
    out.push_back({0, v, glm::dvec2(to_x, to_y) / glm::dvec2(target.camera.width, target.camera.height),
                   cosine * trust / (sigma_px * sigma_px) *
                       certaintyOf(structure.at<cv::Vec3f>(int(to_y), int(to_x)), options.noise_per_px)});
  }
  return out;
}

View reducedView(const View& view, int factor) {
  if (factor == 1 || view.empty()) return view;
  View out;
  out.camera = reducedCamera(view.camera, factor);
  const cv::Size size(out.camera.width, out.camera.height);
  cv::resize(view.grey, out.grey, size, 0, 0, cv::INTER_AREA);
  cv::resize(view.matte, out.matte, size, 0, 0, cv::INTER_AREA);
  return out;
}

}  // namespace

glm::dmat2x3 pixelGradients(const PinholeCamera& camera, const glm::dvec3& point) {
  const glm::dvec3 p = glm::dvec3(camera.cam_from_world * glm::dvec4(point, 1));
  const glm::dmat3 rows = glm::transpose(glm::dmat3(camera.cam_from_world));
  return {(camera.fx / p.z) * (rows[0] - (p.x / p.z) * rows[2]), (camera.fy / p.z) * (rows[1] - (p.y / p.z) * rows[2])};
}

std::vector<View> viewsOf(std::span<const PinholeCamera> cameras, std::span<const Image> pictures, int margin_px) {
  std::vector<View> out(cameras.size());
  inParallel(cameras.size(), [&](size_t c) {
    const Image& picture = pictures[c];
    const cv::Mat rgba = matrixOf(picture);
    cv::Mat alpha, grey;
    cv::extractChannel(rgba, alpha, 3);
    cv::Rect box = cv::boundingRect(alpha >= 128);
    if (box.empty()) return;
    box = cv::Rect(box.x - margin_px, box.y - margin_px, box.width + 2 * margin_px, box.height + 2 * margin_px) &
          cv::Rect(0, 0, picture.width, picture.height);
    cv::cvtColor(rgba(box), grey, cv::COLOR_RGBA2GRAY);
    View& view = out[c];
    view.camera = cameras[c];
    view.camera.cx -= box.x;
    view.camera.cy -= box.y;
    view.camera.width = box.width;
    view.camera.height = box.height;
    view.matte = alpha(box).clone();
    // Hides the background, which does not move with the performer.
    grey.setTo(kBackground, view.matte < 128);
    view.grey = grey;
  });
  return out;
}

std::vector<glm::vec3> normalsOf(const std::vector<glm::uvec3>& faces, const Positions& positions) {
  std::vector<glm::vec3> normals;
  computeVertexNormals(faces, positions.data(), positions.size(), normals);
  return normals;
}

std::vector<float> visibilityOf(const std::vector<View>& views, const std::vector<glm::uvec3>& faces,
                                const Positions& positions, std::span<const glm::vec3> normals) {
  std::vector<std::vector<float>> by_camera(views.size());
  inParallel(views.size(), [&](size_t c) {
    if (views[c].empty()) return;
    const FaceBuffer buffer = rasterise(views[c].camera, faces, positions, 1);
    const glm::dvec3 centre = views[c].camera.centreInWorld();
    by_camera[c].assign(positions.size(), 0);
    for (size_t v = 0; v < positions.size(); ++v) {
      const glm::dvec3 position = positions[v];
      if (!sees(buffer, views[c].camera.project(position))) continue;
      by_camera[c][v] = float(std::max(0.0, glm::dot(glm::normalize(centre - position), glm::dvec3(normals[v]))));
    }
  });
  std::vector<float> out(positions.size(), 0);
  for (const std::vector<float>& cosines : by_camera)
    for (size_t v = 0; v < cosines.size(); ++v) out[v] = std::max(out[v], cosines[v]);
  return out;
}

std::vector<PixelMatch> matchByFlow(std::span<const glm::uvec3> faces, const PosedViews& source,
                                    const std::vector<View>& target, const Positions& positions,
                                    std::span<const glm::vec3> normals, const FlowMatchOptions& options) {
  std::vector<std::vector<PixelMatch>> matches(target.size());
  inParallel(target.size(), [&](size_t c) {
    if (target[c].empty() || (*source.views)[c].empty()) return;
    matches[c] = matchesOf(faces, reducedView((*source.views)[c], options.reduction), *source.positions,
                           reducedView(target[c], options.reduction), positions, normals, options);
    const glm::dvec2 full(target[c].camera.width, target[c].camera.height);
    for (PixelMatch& match : matches[c]) {
      match.camera = uint32_t(c);
      match.pixel *= full;
    }
  });
  std::vector<PixelMatch> out;
  for (const auto& of_camera : matches) out.insert(out.end(), of_camera.begin(), of_camera.end());
  return out;
}

void addPulls(std::span<const PixelMatch> matches, const std::vector<View>& target, const Positions& positions,
              double reach_px, std::vector<Pull>& pulls) {
  for (const PixelMatch& match : matches) {
    const PinholeCamera& camera = target[match.camera].camera;
    const glm::dvec3 position = positions[match.vertex], at = camera.project(position);
    if (at.z <= 0) continue;
    const glm::dvec2 residual = match.pixel - glm::dvec2(at);
    const double robust = tukeyWeight(4.685 * glm::length(residual) / reach_px);
    if (robust <= 0) continue;
    const glm::dmat2x3 jacobian = pixelGradients(camera, position);
    const glm::dmat2x3 weighted = jacobian * match.information * robust;
    pulls[match.vertex].matrix += weighted * glm::transpose(jacobian);
    pulls[match.vertex].vector += weighted * residual;
  }
}

}  // namespace fourdvt::track
