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

// hints/CAMERA/… will do in a capture of one sequence (`only_sequence`). Empty maps without hints. Errors: FrameSize,
// FileUnreadable, and InvalidArgument for names of cameras and numbers of frames that the capture has not.
Result<Strokes> readStrokes(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                            bool only_sequence);

// The hints of one camera through a sequence.
class HintTrack {
 public:
  // Goes to the next frame; `picture`: RGB; `strokes`: this frame's, or null.
  void advance(const Image& picture, const cv::Mat* strokes);
  // CV_32F: nats that pixels cost more as object, by the strokes of this frame and those that have travelled here;
  // empty if there are none.
  cv::Mat cost() const;
  bool idle() const { return points_.empty(); }

 private:
  struct Point {
    cv::Point2f at;
    bool object;
  };
  cv::Mat grey_, strokes_;  // of the frame
  std::vector<Point> points_;
};

}  // namespace fourdvt::mattes
