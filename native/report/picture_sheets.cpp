// SPDX-License-Identifier: Apache-2.0
#include "report/picture_sheets.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fourdvt::report {
namespace {

constexpr uint8_t kPaper = 24;
constexpr int kGap = 6, kBar = 30, kRowTitle = 120;

cv::Mat wrapped(const Image& image) {
  return {image.height, image.width, CV_MAKETYPE(CV_8U, image.channels), const_cast<uint8_t*>(image.pixels.data())};
}

Image fromMat(const cv::Mat& mat) {
  Image out(mat.cols, mat.rows, 3);
  mat.copyTo(wrapped(out));
  return out;
}

void write(cv::Mat& sheet, const std::string& text, int x, int y, double size, double grey) {
  cv::putText(sheet, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar::all(grey), 1, cv::LINE_AA);
}

// Texture coordinates of a face in 1/16 pixels.
std::array<cv::Point, 3> corners(const MeshTopology& topology, uint32_t face, int side) {
  std::array<cv::Point, 3> points;
  for (int c = 0; c < 3; ++c) {
    const glm::vec2 uv = topology.uvs[topology.face_uvs[face][c]] * float(side) - 0.5f;
    points[static_cast<size_t>(c)] = {static_cast<int>(std::lround(uv.x * 16)),
                                      static_cast<int>(std::lround(uv.y * 16))};
  }
  return points;
}

cv::Scalar scalar(const std::array<uint8_t, 3>& c, double share = 1) {
  return {share * c[0], share * c[1], share * c[2]};
}

void fillFace(cv::Mat& map, const MeshTopology& topology, uint32_t face, const cv::Scalar& colour) {
  const auto points = corners(topology, face, map.cols);
  cv::fillConvexPoly(map, points.data(), 3, colour, cv::LINE_8, 4);
}

// Colour map from black to yellow, RGB; OpenCV's are BGR.
Image heat(const cv::Mat& grey) {
  cv::Mat coloured;
  cv::applyColorMap(grey, coloured, cv::COLORMAP_INFERNO);
  cv::cvtColor(coloured, coloured, cv::COLOR_BGR2RGB);
  return fromMat(coloured);
}

}  // namespace

Image drawSheet(const Sheet& sheet) {
  std::vector<int> widths(sheet.columns.size(), 40), heights(sheet.cells.size(), 1);
  for (size_t r = 0; r < sheet.cells.size(); ++r)
    for (size_t c = 0; c < std::min(sheet.cells[r].size(), widths.size()); ++c) {
      widths[c] = std::max(widths[c], sheet.cells[r][c].width);
      heights[r] = std::max(heights[r], sheet.cells[r][c].height);
    }
  const int left = sheet.rows.empty() ? kGap : kRowTitle, top = (sheet.title.empty() ? 0 : kBar) + kBar;
  int width = left, height = top;
  for (const int w : widths) width += w + kGap;
  for (const int h : heights) height += h + kGap;
  Image out(width, height, 3, kPaper);
  cv::Mat canvas = wrapped(out);
  if (!sheet.title.empty()) write(canvas, sheet.title, kGap + 4, 22, 0.6, 240);
  int x = left;
  for (size_t c = 0; c < widths.size(); x += widths[c++] + kGap)
    write(canvas, sheet.columns[c], x + 2, top - 10, 0.5, 190);
  int y = top;
  for (size_t r = 0; r < heights.size(); y += heights[r++] + kGap) {
    if (r < sheet.rows.size()) write(canvas, sheet.rows[r], kGap + 4, y + 18, 0.45, 190);
    x = left;
    for (size_t c = 0; c < widths.size(); x += widths[c++] + kGap) {
      if (c >= sheet.cells[r].size() || sheet.cells[r][c].empty()) continue;
      const Image& cell = sheet.cells[r][c];
      wrapped(cell).copyTo(canvas(cv::Rect(x, y, cell.width, cell.height)));
    }
  }
  return out;
}

std::array<uint8_t, 3> labelColour(uint8_t camera) {
  if (camera >= 31) return {64, 64, 64};
  std::array<uint8_t, 3> out{};
  constexpr double kOffsets[] = {0, 2.0 / 3, 1.0 / 3};
  for (size_t c = 0; c < 3; ++c) {
    const double turned = camera * 0.618034 + kOffsets[c], hue = turned - std::floor(turned);
    out[c] = static_cast<uint8_t>(std::lround(255 * (0.15 + 0.85 * std::clamp(std::abs(hue * 6 - 3) - 1, 0.0, 1.0))));
  }
  return out;
}

Image cameraMap(const MeshTopology& topology, std::span<const uint8_t> labels, int side) {
  Image out(side, side, 3, 0);
  cv::Mat map = wrapped(out);
  const auto faces = static_cast<uint32_t>(std::min<size_t>(topology.faceCount(), labels.size()));
  for (uint32_t f = 0; f < faces; ++f) fillFace(map, topology, f, scalar(labelColour(labels[f])));
  return out;
}

Image changeMap(const MeshTopology& topology, std::span<const uint8_t> before, std::span<const uint8_t> after,
                int side) {
  Image out(side, side, 3, 0);
  cv::Mat map = wrapped(out);
  const size_t faces = std::min({static_cast<size_t>(topology.faceCount()), before.size(), after.size()});
  for (uint32_t f = 0; f < faces; ++f) {
    const bool changed = before[f] != after[f];
    fillFace(map, topology, f, changed ? cv::Scalar(255, 255, 255) : scalar(labelColour(after[f]), 0.25));
  }
  return out;
}

Image cameraLegend(const std::vector<std::string>& names, int width, int height) {
  Image out(width, height, 3, kPaper);
  cv::Mat canvas = wrapped(out);
  const int row = std::min(28, (height - 8) / (static_cast<int>(names.size()) + 1));
  auto entry = [&](int index, const std::array<uint8_t, 3>& colour, const std::string& name) {
    const int y = 4 + row * index;
    cv::rectangle(canvas, cv::Rect(10, y + 2, 26, row - 6), scalar(colour), cv::FILLED);
    write(canvas, name, 46, y + row - 9, 0.45, 220);
  };
  int index = 0;
  for (const std::string& name : names) {
    entry(index, labelColour(static_cast<uint8_t>(index)), name);
    ++index;
  }
  entry(index, labelColour(255), "no camera left");
  return out;
}

Image shareMap(const std::vector<uint8_t>& values, const Image& alpha) {
  Image out = heat(cv::Mat(alpha.height, alpha.width, CV_8U, const_cast<uint8_t*>(values.data())));
  for (int y = 0; y < alpha.height; ++y)
    for (int x = 0; x < alpha.width; ++x)
      if (alpha.at(x, y)[3] < 128) std::fill_n(out.at(x, y), 3, uint8_t{32});
  return out;
}

Image overGrey(const Image& image, uint8_t grey) {
  if (image.channels == 3) return image;
  Image out(image.width, image.height, 3);
  for (size_t i = 0; i < out.pixels.size() / 3; ++i) {
    const int alpha = image.pixels[4 * i + 3];
    for (size_t c = 0; c < 3; ++c)
      out.pixels[3 * i + c] =
          static_cast<uint8_t>((image.pixels[4 * i + c] * alpha + grey * (255 - alpha) + 127) / 255);
  }
  return out;
}

Image scaledTo(const Image& image, int width, int height) {
  Image out(width, height, image.channels);
  cv::Mat target = wrapped(out);
  cv::resize(wrapped(image), target, {width, height}, 0, 0, width < image.width ? cv::INTER_AREA : cv::INTER_CUBIC);
  return out;
}

Image cropped(const Image& image, int x, int y, int width, int height) {
  const cv::Rect part = cv::Rect(x, y, width, height) & cv::Rect(0, 0, image.width, image.height);
  Image out(part.width, part.height, image.channels);
  if (!out.empty()) wrapped(image)(part).copyTo(wrapped(out));
  return out;
}

std::array<int, 4> shownBox(const Image& rgba, int margin) {
  int left = rgba.width, top = rgba.height, right = 0, bottom = 0;
  for (int y = 0; y < rgba.height; ++y)
    for (int x = 0; x < rgba.width; ++x) {
      if (rgba.at(x, y)[3] < 128) continue;
      left = std::min(left, x), right = std::max(right, x + 1);
      top = std::min(top, y), bottom = std::max(bottom, y + 1);
    }
  if (right <= left) return {0, 0, rgba.width, rgba.height};
  left = std::max(0, left - margin), top = std::max(0, top - margin);
  right = std::min(rgba.width, right + margin), bottom = std::min(rgba.height, bottom + margin);
  return {left, top, right - left, bottom - top};
}

}  // namespace fourdvt::report
