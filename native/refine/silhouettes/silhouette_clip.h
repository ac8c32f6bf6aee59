// SPDX-License-Identifier: Apache-2.0
// Silhouettes of all cameras over a window of consecutive frames, as signed distances to their outlines, interpolated
// between frames. Each camera has its own time; others_hull.h aligns them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/capture.h"
#include "silhouette/silhouette.h"

namespace fourdvt::refine {

// Sample on a silhouette's outline.
struct EdgePoint {
  glm::vec2 pixel{0}, outward{0};  // in the reduced picture; unit
  float pixels_per_frame = 0;      // speed of the outline along `outward`
};

class SilhouetteClip {
 public:
  // `cameras`: those of the added silhouettes. `loop`: the last frame is followed by the first.
  SilhouetteClip(std::vector<PinholeCamera> cameras, bool loop) : cameras_(std::move(cameras)), loop_(loop) {}
  // Appends a frame: coverages (1 channel) of the cameras' sizes, one per camera.
  void add(const std::vector<Image>& coverages);

  const std::vector<PinholeCamera>& cameras() const { return cameras_; }
  size_t frames() const { return frames_.size(); }
  uint32_t first_frame = 0;  // in the sequence
  // At most `most` frames, evenly spread.
  std::vector<size_t> spreadFrames(size_t most) const;
  // About `count` samples along the outline, without the picture's border.
  std::vector<EdgePoint> edge(size_t camera, size_t frame, size_t count) const;

  // The two frames around an instant of a camera's own time, in frames from the first; null before the first and after
  // the last frame of a clip that is no loop, and where the camera has no silhouette.
  struct Instant {
    const silhouette::SilhouetteDistance *before = nullptr, *after = nullptr;
    float share = 0;  // weight of `after`
    // Pixels, positive inside; kOutside beyond the picture.
    float at(double x, double y) const {
      const float first = before->at(x, y);
      return share > 0 ? first + share * (after->at(x, y) - first) : first;
    }
  };
  Instant instant(size_t camera, double frame) const;
  // Bounding box, pixels, of the silhouette at the frame nearest to an instant; none as in instant().
  std::optional<std::pair<glm::dvec2, glm::dvec2>> boundsAt(size_t camera, double frame) const;

 private:
  std::vector<PinholeCamera> cameras_;
  bool loop_;
  std::vector<std::vector<silhouette::SilhouetteDistance>> frames_;  // [frame][camera]
  std::vector<std::vector<std::vector<glm::vec2>>> outlines_;        // [frame][camera] pixels beside the outline
};

// Reads the middle of a sequence: at most `max_frames` frames, with pictures reduced such that the distances of all
// `clips` clips take at most about 300 MB. The clip is a loop only if it has all frames of one. `on_frame` receives the
// finished share and returns false to stop (error Interrupted). Other errors: those of FrameReader.
Result<SilhouetteClip> readSilhouetteClip(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                          const OpenVideo& open_video, uint32_t max_frames, size_t clips,
                                          const std::function<bool(double share)>& on_frame);

}  // namespace fourdvt::refine
