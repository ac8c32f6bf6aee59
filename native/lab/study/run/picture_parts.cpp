// SPDX-License-Identifier: Apache-2.0
#include "lab/study/run/picture_parts.h"

#include <algorithm>
#include <cmath>

#include "lab/measure/seam_contrast.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "platform/files.h"

namespace fourdvt::study {

std::vector<double> middleAzimuths_deg(const std::vector<PinholeCamera>& cameras) {
  glm::dvec3 centre(0);
  for (const PinholeCamera& camera : cameras) centre += camera.centreInWorld() / static_cast<double>(cameras.size());
  std::vector<double> azimuths;
  for (const PinholeCamera& camera : cameras) {
    const glm::dvec3 d = camera.centreInWorld() - centre;
    azimuths.push_back(glm::degrees(std::atan2(d.x, d.z)));
  }
  std::sort(azimuths.begin(), azimuths.end());
  std::vector<double> out;
  for (size_t i = 0; i < azimuths.size(); ++i) {
    const double next = i + 1 < azimuths.size() ? azimuths[i + 1] : azimuths[0] + 360;
    out.push_back((azimuths[i] + next) / 2);
  }
  return out;
}

std::vector<uint8_t> shareOf(const Image& shares, int layer) {
  std::vector<uint8_t> out(shares.pixels.size() / 4);
  for (size_t i = 0; i < out.size(); ++i) {
    const uint8_t* p = &shares.pixels[4 * i];
    out[i] = layer < 3 ? p[layer] : static_cast<uint8_t>(std::max(0, 255 - p[0] - p[1] - p[2]));
  }
  return out;
}

Image bodyCell(const Image& rgb, const std::array<int, 4>& box) {
  const double scale = std::min(double(kBodyHeight) / box[3], double(kCell) / box[2]);
  return report::scaledTo(report::cropped(rgb, box[0], box[1], box[2], box[3]), static_cast<int>(scale * box[2]),
                          static_cast<int>(scale * box[3]));
}

std::vector<Image> viewWithCrops(const Image& picture, const std::array<int, 4>& box) {
  const auto [left, top, width, height] = box;
  const Image shown = report::overGrey(report::cropped(picture, left, top, width, height));
  std::vector<Image> out{report::scaledTo(shown, std::max(1, shown.width * 420 / shown.height), 420)};
  const int side = std::min(width, height) / 3;
  for (const double along : {0.12, 0.42, 0.75}) {
    const int x = left + (width - side) / 2, y = top + static_cast<int>(along * height) - side / 2;
    const Image part =
        report::overGrey(report::cropped(picture, x, std::clamp(y, top, top + height - side), side, side));
    out.push_back(report::scaledTo(part, 420, 420));
  }
  return out;
}

std::optional<glm::dvec3> backdropColour(const capture::Capture& capture) {
  if (capture.background_folder.empty()) return std::nullopt;
  auto plate = platform::readImage(capture.background_folder + "/" + capture.cameras[0].pinhole.name + ".png");
  if (!plate.ok() || plate.value().channels < 3) return std::nullopt;
  const Image& image = plate.value();
  glm::dvec3 sum(0);
  const size_t pixels = image.pixels.size() / static_cast<size_t>(image.channels);
  for (size_t i = 0; i < pixels; ++i)
    for (int c = 0; c < 3; ++c)
      sum[c] += image.pixels[i * static_cast<size_t>(image.channels) + static_cast<size_t>(c)];
  return sum / static_cast<double>(pixels);
}

void SeamTable::add(const std::string& method, const std::string& view, const measure::CharacterFrame& frame,
                    const PinholeCamera& camera, const Image& picture) {
  const measure::SeamContrast contrast =
      measure::seamContrast(report::overGrey(picture, 0), camera, frame.topology, frame.positions);
  Sums& sum = sums_[{method, view}];
  if (contrast.samples) {
    sum.seam += contrast.seam * static_cast<double>(contrast.samples);
    sum.control += contrast.control * static_cast<double>(contrast.samples);
    sum.samples += contrast.samples;
  }
  const double fringe = backdrop_ ? measure::fringeShare(picture, *backdrop_) : std::nan("");
  if (!std::isnan(fringe)) sum.fringe += fringe, ++sum.pictures;
}

void SeamTable::write(Rows& out, const std::string& sequence) const {
  for (const auto& [key, sum] : sums_) {
    const RowWriter row(out, rows::kSeams, sequence, key.first, "view=" + key.second);
    if (sum.samples) {
      row.add({{rows::kSeamContrast, sum.seam / static_cast<double>(sum.samples)},
               {rows::kSeamControl, sum.control / static_cast<double>(sum.samples)}});
    }
    if (sum.pictures) row.add({{rows::kFringePercent, 100 * sum.fringe / static_cast<double>(sum.pictures)}});
  }
}

}  // namespace fourdvt::study
