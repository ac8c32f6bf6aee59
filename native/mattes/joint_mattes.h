// SPDX-License-Identifier: Apache-2.0
// Joint mattes of all cameras at one instant. Each camera is keyed against its plates; then, twice, each pixel is
// judged by the other cameras' masks: pixels outside them cost more as object, pixels inside all of them less, and dark
// patches that lie wholly on the floor become floor. Large pictures are cut at a reduced size first, and again at full
// size along the outline. One instant, no files. Method: algorithms/mattes.md.
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
  bool alone = false;              // every camera by itself
  int rounds = 2;                  // rounds of support and cut after the cameras' own keys
  double slack_pixels = 3;         // tolerance for masks that are too small and for calibration errors
  float contradicted_nats = 12;    // cost as object where several of the others contradict it
  float doubted_nats = 3;          // cost as object where one of the others, possibly wrong, contradicts it
  float demanded_nats = 0.15;      // maximum reduction of the cost where all others have the object, for each of them
                                   // from the sixth on: the hull of few cameras fills armpits
  float floor_nats = 2;            // cost as object where it can only lie on the floor
  float shadow_nats = 4;           // cost as object on the floor where all cameras see a shadow
  bool floor = true;               // patches on the floor are shadows
  double floor_share = 0.015;      // share of the performer's height: points lower than this and the slack are on the
                                   // floor
  double shadow_share = 0.25;      // floor_share for points that all cameras see darker than the plates by one ratio
  bool background_unseen = false;  // unjudged pixels are background, e.g. without plates
};

// One camera's input at an instant, as filmed.
struct MatteView {
  Image picture;                            // RGB
  const BackgroundModel* plates = nullptr;  // null: `given` is the only source
  bool fit_plates = true;                   // fits the plates to the picture, see fitPlate
  const ColourCounts* colours = nullptr;    // colours from other frames, may be null
  Image given;                              // one channel
  bool given_is_final = false;              // `given` is the capture's matte; false: others may remove parts
  cv::Mat hints;                            // CV_32F, see HintTrack::cost; may be empty
  cv::Mat more_cost;                        // CV_32F, nats against the object; may be empty
};

struct CameraMatte {
  Image matte;  // one channel
  cv::Mat own;  // CV_8U, the picture's size: the camera's own key, before other cameras are used
  // CV_8U, the picture's size: object in the camera's own key but not in the result: 255 contradicted by others, 128 on
  // the floor, 64 another reason. Empty if not computed.
  cv::Mat dropped;
  float shift_pixels = 0, gain = 1, residual_levels = 0;  // fit of the plates to this picture
  double supported = 1;                                   // share of the camera's own key that no other contradicts
  double kept = 1;                                        // share of the camera's own key that remains in the result
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
