// SPDX-License-Identifier: Apache-2.0
// A baked character against its capture: at the held-out cameras (straight-alpha ground truth pictures) and at the
// input cameras (video frames, with the backdrop taken out of their matte's soft edges). Both pictures over black; the
// region is the union of both silhouettes (alpha >= 128). PSNR on RGB, SSIM on luma, see metrics.h. And how the
// character flickers, see FlickerScore. Memory: one frame of capture pictures and three pictures per sequence for the
// contact sheet.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "base/image.h"
#include "capture/capture.h"
#include "edge/character_player.h"

namespace fourdvt::measure {

struct HeldOutOptions {
  std::vector<std::string> sequences;  // empty: all of the character
  uint32_t input_every = 4;            // input cameras: every Nth frame from 0; 0: not at all
  bool yardstick = false;              // also plain projective texturing at the held-out cameras, see projective.h
  uint32_t flicker_cameras = 0;        // flicker at the first N input cameras, and on the orbit; 0: not at all
};

inline constexpr double kNotAsked = std::numeric_limits<double>::quiet_NaN();

struct ViewScore {
  std::string sequence, camera;
  uint32_t frame = 0;
  bool held_out = true;          // false: an input camera
  double psnr_db = 0, ssim = 0;  // layered character, over the union of the silhouettes
  double common_psnr_db = 0;     // over their common part: how much of the error is the outline's
  double yardstick_psnr_db = kNotAsked, yardstick_ssim = kNotAsked, yardstick_common_psnr_db = kNotAsked;
};

// The view with the lowest SSIM of one sequence's held-out views. All RGB over black, of the camera's size.
struct WorstView {
  ViewScore score;
  Image truth, character, yardstick;  // yardstick may be empty
};

// Between two consecutive pictures that are drawn a frame period apart, so that what follows with time does. Of one
// sequence, at an input camera: what changes of the error against that camera's pictures on the surface
// (flickerLevels). The same picture is in the layers, at both ends. On the orbit, whose camera is kOrbit: what changes
// of the colours on the surface while frame 0 is looked at from 1 degree further each time, kOrbitPictures of them from
// the first input camera on; no camera has pictures there. NaN where the surface is not seen in both.
inline constexpr const char* kOrbit = "orbit";
inline constexpr uint32_t kOrbitPictures = 46;      // past a camera of a ring of eight
inline constexpr uint32_t kMostFlickerFrames = 64;  // of a sequence, from frame 0
struct FlickerScore {
  std::string sequence, camera;
  uint32_t frame = 0;  // or picture of the orbit: the later of the two
  double levels = 0;
};
// Mean over those of the sequence and camera, NaN left out; NaN: none.
double meanFlicker(const std::vector<FlickerScore>& scores, const std::string& sequence, const std::string& camera);

struct HeldOutReport {
  std::vector<ViewScore> scores;
  std::vector<FlickerScore> flicker;
  std::vector<WorstView> worst;  // one per sequence that has held-out views
};

// Needs a current GL context behind `character`. `on_frame`, if set, hears of each finished frame of the capture.
// Errors: InvalidArgument (a sequence that one of them lacks), and those of the capture and of the character.
Result<HeldOutReport> evaluateHeldOut(
    const capture::Capture& capture, const OpenVideo& open_video, edge::CharacterPlayer& character,
    const HeldOutOptions& options,
    const std::function<void(const std::string& sequence, uint32_t frame)>& on_frame = {});

// Means over the scores with these properties; an empty name means any.
struct MeanViewScore {
  size_t views = 0;
  double psnr_db = 0, ssim = 0, common_psnr_db = 0;
  double yardstick_psnr_db = 0, yardstick_ssim = 0, yardstick_common_psnr_db = 0;
};
MeanViewScore meanViewScore(const std::vector<ViewScore>& scores, bool held_out, const std::string& sequence,
                            const std::string& camera);

// Fixed-width table: per sequence and camera, means, worst views. Yardstick columns only where there are figures.
std::string scoreTable(const HeldOutReport& report);
std::string scoreCsv(const HeldOutReport& report);
// Rows: worst views; columns: truth, character, (yardstick,) absolute difference × 4. Cropped to the performer.
// `baseline` names what WorstView::yardstick shows.
Image contactSheet(const std::vector<WorstView>& worst, const std::string& baseline = "yardstick");

}  // namespace fourdvt::measure
