// SPDX-License-Identifier: Apache-2.0
// Strokes painted by hand where mattes go wrong, hints/SEQUENCE/CAMERA/000012.png: opaque white is the performer,
// opaque black the background, everything else is left open. They hold in their frame, and travel on with what they
// were painted on (Lucas-Kanade, checked by tracking back) for as long as it looks the same. Does NOT reach back in
// time.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/image.h"
#include "capture/capture.h"

namespace fourdvt::mattes {

inline constexpr uint8_t kObjectStroke = 255, kBackgroundStroke = 1;  // 0: none
inline constexpr float kObeyed = 1e4f;                                // nats: what a stroke weighs in its frame

// Strokes of one sequence: [camera][frame] CV_8U, as filmed.
using Strokes = std::vector<std::map<uint32_t, cv::Mat>>;

// hints/CAMERA/… will do in a capture of one sequence. Hints of cameras and sequences that take no part (left out, not
// asked for) are not read. Empty maps without hints. Errors: FrameSize, FileUnreadable, and InvalidArgument for numbers
// of frames that the sequence has not, files that are no hints, and names that neither the calibration nor the
// capture's folder has.
Result<Strokes> readStrokes(const capture::Capture& capture, const capture::CaptureSequence& sequence);

// The hints of one camera through a sequence.
class HintTrack {
 public:
  // Goes to the next frame; `picture`: RGB; `strokes`: this frame's, or null.
  void advance(const Image& picture, const cv::Mat* strokes);
  // CV_32F: nats that pixels cost more as object, by the strokes of this frame and those that have travelled here;
  // empty if there are none.
  cv::Mat cost() const;
  bool idle() const { return points_.empty() && strokes_.empty(); }

 private:
  struct Point {
    cv::Point2f at;
    bool object;
  };
  void addPoint(const cv::Mat& strokes, int cell_x, int cell_y);

  cv::Mat grey_, strokes_;  // of the frame
  std::vector<Point> points_;
};

}  // namespace fourdvt::mattes
