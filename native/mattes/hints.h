// SPDX-License-Identifier: Apache-2.0
// Hand-painted strokes that correct mattes, hints/SEQUENCE/CAMERA/000012.png: opaque white is the performer, opaque
// black the background, everything else is undecided. Strokes apply to their frame, and are tracked forwards
// (Lucas-Kanade, with a forward-backward check) while the patch looks the same.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/image.h"
#include "capture/capture.h"

namespace fourdvt::mattes {

inline constexpr uint8_t kObjectStroke = 255, kBackgroundStroke = 1;  // 0: none
inline constexpr float kObeyed = 1e4f;                                // nats: weight of a stroke in its frame

// Strokes of one sequence: [camera][frame] CV_8U, as filmed.
using Strokes = std::vector<std::map<uint32_t, cv::Mat>>;

// Reads hints/SEQUENCE/CAMERA/…, or hints/CAMERA/… in a capture of one sequence. Hints of cameras and sequences that
// are left out or not selected are skipped. Empty maps without hints. Errors: FrameSize, FileUnreadable, and
// InvalidArgument for frame numbers outside the sequence, files that are no hints, and names that neither the
// calibration nor the capture's folder contains.
Result<Strokes> readStrokes(const capture::Capture& capture, const capture::CaptureSequence& sequence);

// Hints of one camera through a sequence.
class HintTrack {
 public:
  // Advances to the next frame; `picture`: RGB; `strokes`: this frame's, or null.
  void advance(const Image& picture, const cv::Mat* strokes);
  // CV_32F: additional nats of pixels as object, from the strokes of this frame and from tracked ones; empty if there
  // are none.
  cv::Mat cost() const;
  bool idle() const { return points_.empty() && strokes_.empty(); }

 private:
  struct Point {
    cv::Point2f at;
    bool object;
  };
  void addPoint(const cv::Mat& strokes, int cell_x, int cell_y);

  cv::Mat grey_, strokes_;  // current frame
  std::vector<Point> points_;
};

}  // namespace fourdvt::mattes
