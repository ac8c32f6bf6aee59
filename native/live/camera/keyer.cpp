// SPDX-License-Identifier: Apache-2.0
// Fine stage of the live key: key_cells.h locates the outline, and pixels near it are compared with the plate times the
// gain of the nearby background. The difference grows linearly with coverage, so coverage is one half where the
// difference is half of its value within the performer two pixels away.
#include "live/camera/keyer.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/opencv_image.h"
#include "live/camera/key_cells.h"
#include "mattes/background_model.h"

namespace fourdvt::live {
namespace {

constexpr float kCellTolerance = 7;    // levels, root of the sum of three channels' squares
constexpr float kPixelTolerance = 14;  // same unit
constexpr float kFromModel = 2.5f;     // standard deviations of the plates and their edges added to the tolerance
constexpr int kContrastReach_px = 2;   // radius within which the performer's full difference is found
// Maximum deviation of a pixel's shade from its cell's gain.
constexpr float kShadeBeside = 0.15f, kChromaShadeBeside = 0.5f;
constexpr float kChromaLeastShade = 0.3f, kChromaMostShade = 1.5f;

class PlateKeyer final : public Keyer {
 public:
  explicit PlateKeyer(const mattes::BackgroundModel& model)
      : mean_(mattes::meanPicture(model)),
        chroma_(mattes::isChromaPlate(mean_)),
        shade_beside_(chroma_ ? kChromaShadeBeside : kShadeBeside),
        cell_px_(cellSideFor(mean_.width, mean_.height)),
        tolerance_(tolerances(model)),
        cells_(cellModel(), cell_px_),
        coverage_(mean_.width, mean_.height, 1),
        difference_(mean_.width, mean_.height, 1) {}

  Result<const Image*> key(const Image& picture) override {
    if (picture.width != mean_.width || picture.height != mean_.height || picture.channels != 3)
      return Error{ErrorId::InvalidArgument, "keyer: picture of another size than the plates; take new plates"};
    const Cells& cells = cells_.key(picture);
    std::fill(coverage_.pixels.begin(), coverage_.pixels.end(), uint8_t(0));
    if (!cells.any) return &coverage_;
    const cv::Rect box = compare(picture, cells);
    cover(box, cells);
    return &coverage_;
  }

 private:
  // Maximum difference of a background pixel, levels.
  Image tolerances(const mattes::BackgroundModel& model) const {
    Image out(model.width, model.height, 1);
    for (size_t i = 0; i < out.pixels.size(); ++i)
      out.pixels[i] = uint8_t(std::min(255.0f, kPixelTolerance + kFromModel * std::sqrt(3 * model.extra[i])));
    cv::Mat grown = matrixOf(out);
    cv::dilate(grown, grown, cv::Mat::ones(3, 3, CV_8U));
    return out;
  }

  CellModel cellModel() const {
    CellModel model;
    model.plate = mean_;
    if (chroma_) {
      model.min_shade = kChromaLeastShade;
      model.max_shade = kChromaMostShade;
    }
    Image three(mean_.width, mean_.height, 3);
    cv::Mat out = matrixOf(three);
    cv::cvtColor(matrixOf(tolerance_), out, cv::COLOR_GRAY2RGB);
    CellMeans tolerance;
    reduceToCells(three, cell_px_, tolerance);
    if (!chroma_) model.texture_tolerance = tolerance.channel[0];
    for (const float t : tolerance.channel[0])
      model.tolerance.push_back(kCellTolerance + (t - kPixelTolerance) / float(cell_px_));
    return model;
  }

  // Writes pixel differences in outline cells and the cell's own difference in performer cells; 0 elsewhere within
  // their bounding box, which is returned.
  cv::Rect compare(const Image& picture, const Cells& cells) {
    const int columns = cells_.columns(), rows = cells_.rows();
    int low_x = columns, low_y = rows, high_x = -1, high_y = -1;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x)
        if (cells.kind[size_t(y) * columns + x] != CellKind::Background)
          low_x = std::min(low_x, x), high_x = std::max(high_x, x), low_y = std::min(low_y, y), high_y = y;
    const cv::Rect box = cv::Rect(cv::Point(low_x * cell_px_, low_y * cell_px_),
                                  cv::Point((high_x + 1) * cell_px_, (high_y + 1) * cell_px_)) &
                         cv::Rect(0, 0, picture.width, picture.height);
    matrixOf(difference_)(box).setTo(0);
    for (int y = low_y; y <= high_y; ++y)
      for (int x = low_x; x <= high_x; ++x) {
        const size_t cell = size_t(y) * columns + x;
        if (cells.kind[cell] == CellKind::Outline) compareCell(picture, cells, x, y);
        if (cells.kind[cell] == CellKind::Performer)
          fillCell(x, y, cells_.plainDifference(cell, cells_.gainAt(x, y)), difference_);
      }
    return box;
  }

  void compareCell(const Image& picture, const Cells& cells, int cell_x, int cell_y) {
    const int x0 = cell_x * cell_px_, x1 = std::min(x0 + cell_px_, picture.width);
    const int y0 = cell_y * cell_px_, y1 = std::min(y0 + cell_px_, picture.height);
    const std::array<float, 3> gain = cells_.gainAt(cell_x, cell_y);
    const float scale = 1 / toleranceScale(cells);
    for (int y = y0; y < y1; ++y) {
      const uint8_t *now = picture.at(x0, y), *plate = mean_.at(x0, y), *tolerance = tolerance_.at(x0, y);
      uint8_t* out = difference_.at(x0, y);
      for (int x = x0; x < x1; ++x, now += 3, plate += 3)
        *out++ = pixelDifference(now, plate, gain, scale / float(*tolerance++));
    }
  }

  uint8_t pixelDifference(const uint8_t* now, const uint8_t* plate, const std::array<float, 3>& gain,
                          float per_tolerance) const {
    const float r = gain[0] * float(plate[0]), g = gain[1] * float(plate[1]), b = gain[2] * float(plate[2]);
    const float dr = float(now[0]) - r, dg = float(now[1]) - g, db = float(now[2]) - b;
    const float luma = r + 2 * g + b + 4, step = dr + 2 * dg + db;
    const float shade = std::min(shade_beside_, std::max(-shade_beside_, step / luma));
    const float sr = dr - shade * r, sg = dg - shade * g, sb = db - shade * b;
    const float plain2 = dr * dr + dg * dg + db * db, shaded2 = sr * sr + sg * sg + sb * sb;
    const float weight2 = std::min(1.0f, shaded2 * per_tolerance * per_tolerance);
    return uint8_t(std::min(255.0f, std::sqrt(plain2 * weight2)));
  }

  // Factor on the pixels' tolerances; grows with the picture's noise.
  static float toleranceScale(const Cells& cells) { return std::max(1.0f, cells.threshold / 2); }

  void cover(const cv::Rect& box, const Cells& cells) {
    cv::Mat difference = matrixOf(difference_)(box);
    cv::GaussianBlur(difference, smooth_, {3, 3}, 0, 0, cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
    const int side = 2 * kContrastReach_px + 1;
    cv::dilate(smooth_, contrast_, cv::Mat::ones(side, side, CV_8U));
    const float scale = toleranceScale(cells);
    for (int y = 0; y < box.height; ++y) {
      const uint8_t *d = smooth_.ptr(y), *most = contrast_.ptr(y), *tolerance = tolerance_.at(box.x, box.y + y);
      uint8_t* out = coverage_.at(box.x, box.y + y);
      for (int x = 0; x < box.width; ++x) {
        const float half = std::max(scale * float(tolerance[x]), 0.5f * float(most[x]));
        out[x] = uint8_t(std::min(255.0f, 127.5f * float(d[x]) / half + 0.5f));
      }
    }
    cv::Mat coverage = matrixOf(coverage_)(box);
    cv::morphologyEx(coverage, coverage, cv::MORPH_CLOSE, cv::Mat::ones(3, 3, CV_8U));
    const int columns = cells_.columns(), rows = cells_.rows();
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x)
        if (cells.kind[size_t(y) * columns + x] == CellKind::Performer) fillCell(x, y, 255, coverage_);
  }

  void fillCell(int cell_x, int cell_y, uint8_t value, Image& out) const {
    const int x0 = cell_x * cell_px_, width = std::min(cell_px_, out.width - x0);
    const int y0 = cell_y * cell_px_, y1 = std::min(y0 + cell_px_, out.height);
    for (int y = y0; y < y1; ++y) std::fill_n(out.at(x0, y), width, value);
  }

  const Image mean_;
  const bool chroma_;
  const float shade_beside_;
  const int cell_px_;
  const Image tolerance_;
  CellKey cells_;
  Image coverage_, difference_;
  cv::Mat smooth_, contrast_;  // scratch
};

}  // namespace

Result<std::unique_ptr<Keyer>> Keyer::create(const std::vector<Image>& plates) {
  if (plates.empty()) return Error{ErrorId::InvalidArgument, "keyer: no plates; take one of the empty stage"};
  for (const Image& plate : plates)
    if (plate.empty() || plate.channels != 3 || plate.width != plates[0].width || plate.height != plates[0].height)
      return Error{ErrorId::InvalidArgument, "keyer: plates must be RGB and of one size; take them again"};
  return std::unique_ptr<Keyer>(std::make_unique<PlateKeyer>(mattes::makeBackgroundModel(plates)));
}

}  // namespace fourdvt::live
