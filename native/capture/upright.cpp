// SPDX-License-Identifier: Apache-2.0
#include "capture/upright.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "base/text.h"

namespace fourdvt::capture {
namespace {

struct Size {
  int width = 0, height = 0;
  bool operator==(const Size& o) const { return width == o.width && height == o.height; }
};

std::string text(const Size& size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

// Size after stretching: wide pixels widen the picture, narrow ones heighten it, so that no detail is lost.
Size stretched(const Size& size, double pixel_aspect) {
  if (pixel_aspect >= 1) return {static_cast<int>(std::lround(size.width * pixel_aspect)), size.height};
  return {size.width, static_cast<int>(std::lround(size.height / pixel_aspect))};
}

// Size of a stored picture with these marks.
Size shownSize(const Image& stored, const PictureMarks& marks) {
  const Size size = stretched({stored.width, stored.height}, marks.pixel_aspect);
  return marks.swapsSides() ? Size{size.height, size.width} : size;
}

PictureMarks without(PictureMarks marks, bool turn, bool stretch) {
  if (!turn) marks.mirrored = false, marks.quarter_turns = 0;
  if (!stretch) marks.pixel_aspect = 1;
  return marks;
}

// Marks with which the picture gets the camera's size, turned or not; unstretched takes precedence.
std::optional<PictureMarks> fitting(const Image& stored, const PictureMarks& marks, const CaptureCamera& camera,
                                    bool turn) {
  const Size wanted{camera.pinhole.width, camera.pinhole.height};
  for (const bool stretch : {false, true})
    if (const PictureMarks chosen = without(marks, turn, stretch); shownSize(stored, chosen) == wanted) return chosen;
  return std::nullopt;
}

cv::Mat viewOf(Image& image) { return {image.height, image.width, CV_8UC(image.channels), image.pixels.data()}; }

}  // namespace

std::string describe(const PictureMarks& marks) {
  std::string out = marks.mirrored ? "mirrored" : "";
  const auto add = [&](const std::string& more) { out += (out.empty() ? "" : " and ") + more; };
  if (marks.quarter_turns != 0) add("turned by " + std::to_string(90 * marks.quarter_turns) + "°");
  if (marks.stretches()) add(printed("with pixels of %.4g to 1", marks.pixel_aspect));
  return out;
}

Image applyMarks(Image stored, const PictureMarks& marks) {
  if (marks.stretches()) {
    const Size size = stretched({stored.width, stored.height}, marks.pixel_aspect);
    Image out(size.width, size.height, stored.channels);
    cv::Mat target = viewOf(out);
    cv::resize(viewOf(stored), target, target.size(), 0, 0, cv::INTER_CUBIC);
    stored = std::move(out);
  }
  if (marks.mirrored) {
    cv::Mat view = viewOf(stored);
    cv::flip(view, view, 1);
  }
  if (marks.quarter_turns == 0) return stored;
  const Size size = shownSize(stored, without(marks, true, false));
  Image out(size.width, size.height, stored.channels);
  cv::Mat target = viewOf(out);
  cv::rotate(viewOf(stored), target, marks.quarter_turns - 1);  // cv::ROTATE_90_CLOCKWISE is 0, then 180°, 270°
  return out;
}

Result<PictureMarks> calibratedMarks(const Image& stored, const PictureMarks& marks, const CaptureCamera& camera,
                                     const std::string& path) {
  const auto as_stored = fitting(stored, marks, camera, false);
  const auto turned = marks.turns() ? fitting(stored, marks, camera, true) : as_stored;
  if (as_stored && turned && marks.turns() && camera.orientation == Orientation::BySize)
    return orientationIsOpen(marks, camera, path);
  const bool prefers_stored = camera.orientation == Orientation::Stored || !marks.turns();
  const auto& chosen = prefers_stored                                         ? as_stored
                       : camera.orientation == Orientation::BySize && !turned ? as_stored
                                                                              : turned;
  if (chosen) return *chosen;
  const PinholeCamera& p = camera.pinhole;
  const std::string marked = describe(marks);
  return Error{ErrorId::FrameSize, path + ": " + text({stored.width, stored.height}) + " pixels" +
                                       (marked.empty() ? "" : ", marked as " + marked) + ", but camera " + p.name +
                                       " is calibrated for " + text({p.width, p.height}) +
                                       "; use the pictures that were calibrated"};
}

Result<Image> asCalibrated(Image stored, const PictureMarks& marks, const CaptureCamera& camera,
                           const std::string& path) {
  FOURDVT_ASSIGN(const PictureMarks chosen, calibratedMarks(stored, marks, camera, path));
  return applyMarks(std::move(stored), chosen);
}

Error orientationIsOpen(const PictureMarks& marks, const CaptureCamera& camera, const std::string& path) {
  return {ErrorId::FrameSize,
          path + ": the file marks its pictures as " + describe(without(marks, true, false)) +
              ", and the calibration of camera " + camera.pinhole.name +
              " does not decide whether it is of such pictures; give fourdvt import --orientation marked if it was " +
              "calibrated on pictures as players show them, or stored if on pixels as they lie in the file (in " +
              "capture.json: \"calibration\": {\"orientation\": …})"};
}

}  // namespace fourdvt::capture
