// SPDX-License-Identifier: Apache-2.0
// The silhouettes of all cameras over a window of consecutive frames, as signed distances to their outlines, also
// between frames. Does NOT place frames of different cameras in one time: others_hull.h does.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/capture.h"
#include "silhouette/silhouette.h"

namespace fourdvt::refine {

// A place on the outline of a silhouette.
struct EdgePoint {
  glm::vec2 pixel{0}, outward{0};  // of the reduced picture; unit
  float pixels_per_frame = 0;      // how fast the outline moves along `outward`
};

class SilhouetteClip {
 public:
  // `cameras`: of the pictures that silhouettes are added of. `loop`: the frames follow each other round.
  SilhouetteClip(std::vector<PinholeCamera> cameras, bool loop) : cameras_(std::move(cameras)), loop_(loop) {}
  // The next frame: coverages (1 channel) of the cameras' sizes, one per camera.
  void add(const std::vector<Image>& coverages);

  const std::vector<PinholeCamera>& cameras() const { return cameras_; }
  size_t frames() const { return frames_.size(); }
  uint32_t first_frame = 0;  // of the sequence
  // At most `most` frames, evenly spread.
  std::vector<size_t> spreadFrames(size_t most) const;
  // About `count` places along the outline, the picture's border left out.
  std::vector<EdgePoint> edge(size_t camera, size_t frame, size_t count) const;

  // The two frames beside an instant of a camera's own time, in frames from the first; null before the first and after
  // the last of a clip that is no loop, and where the camera saw nothing.
  struct Instant {
    const silhouette::SilhouetteDistance *before = nullptr, *after = nullptr;
    float share = 0;  // of `after`
    // Pixels, positive inside; kOutside beyond the picture.
    float at(double x, double y) const {
      const float first = before->at(x, y);
      return share > 0 ? first + share * (after->at(x, y) - first) : first;
    }
  };
  Instant instant(size_t camera, double frame) const;
  // Least and greatest pixel of the silhouette at the frame nearest to an instant; none as of instant().
  std::optional<std::pair<glm::dvec2, glm::dvec2>> boundsAt(size_t camera, double frame) const;

 private:
  std::vector<PinholeCamera> cameras_;
  bool loop_;
  std::vector<std::vector<silhouette::SilhouetteDistance>> frames_;  // [frame][camera]
  std::vector<std::vector<std::vector<glm::vec2>>> outlines_;        // [frame][camera] pixels beside the outline
};

// Reads the middle of a sequence: at most `most_frames` frames, pictures reduced such that the distances of `clips`
// such clips take at most about 300 MB. All frames of a loop or none wrap round. `on_frame` hears the share of the work
// done and returns false to stop: then the error is Interrupted. Other errors: those of FrameReader.
Result<SilhouetteClip> readSilhouetteClip(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                          const OpenVideo& open_video, uint32_t most_frames, size_t clips,
                                          const std::function<bool(double share)>& on_frame);

}  // namespace fourdvt::refine
