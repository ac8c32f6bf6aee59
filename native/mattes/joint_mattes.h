// SPDX-License-Identifier: Apache-2.0
// Mattes of all cameras of one instant, made together. Each camera is keyed against its plates; then, twice, every
// pixel counts what the other cameras' masks say of it: what they contradict becomes dear, what they demand cheap, and
// dark patches that lie on the floor as a whole become floor. Large pictures are cut at a reduced size first, and again
// at full size along the outline. Does NOT read files, does NOT look at other frames. Method: algorithms/mattes.md.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/image.h"
#include "capture/capture.h"
#include "mattes/background_model.h"
#include "mattes/key_evidence.h"

namespace fourdvt::mattes {

struct JointOptions {
  bool alone = false;            // every camera for itself
  int rounds = 2;                // of support and cut after the cameras' own keys
  double slack_pixels = 3;       // how far masks of other cameras may be too small, and the calibration off
  float contradicted_nats = 12;  // that a pixel costs more as object where several of the others contradict it
  float doubted_nats = 3;        // … where one does, which may be the one that is wrong
  float demanded_nats = 0.15;    // that it costs less at most where all others have something, for each of them from
                                 // the sixth on: the hull of few cameras fills armpits
  float floor_nats = 2;          // that it costs more where it can only lie on the floor
  float shadow_nats = 4;         // … and where all cameras see a shadow there
  bool floor = true;             // patches on the floor are shadows
  double floor_share = 0.015;    // of the performer's height: what lies lower, by this and the slack, is on the floor
  double shadow_share = 0.25;    // … and if all cameras see it on the floor, darker than the plates by the same ratio
  bool background_unseen = false;  // unjudged pixels are background, e.g. without plates
};

// One camera's part of an instant, as filmed.
struct MatteView {
  Image picture;                            // RGB
  const BackgroundModel* plates = nullptr;  // null: `given` is all there is
  bool fit_plates = true;                   // to the picture, see fitPlate
  const ColourCounts* colours = nullptr;    // of other frames, may be null
  Image given;                              // one channel
  bool given_is_final = false;              // mattes of the capture; else others may drop parts of it
  cv::Mat hints;                            // CV_32F, see HintTrack::cost; may be empty
  cv::Mat more_cost;                        // CV_32F, nats against the object; may be empty
};

struct CameraMatte {
  Image matte;  // one channel
  cv::Mat own;  // CV_8U, the picture's size: the camera's own key, before others joined in
  // CV_8U, the picture's size: where the camera's own key had object and the result has not, 255 where others
  // contradict it, 128 where it lies on the floor, 64 for another reason. Empty if nobody looked.
  cv::Mat dropped;
  float shift_pixels = 0, gain = 1, residual_levels = 0;  // of the plates to this picture
  double supported = 1;                                   // share of the camera's own key that no other contradicts
  double kept = 1;                                        // share of the camera's own key that the result has
};

class JointMattes {
 public:
  JointMattes(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m, const JointOptions& options = {});
  ~JointMattes();
  std::vector<CameraMatte> make(std::span<const MatteView> views) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace fourdvt::mattes
