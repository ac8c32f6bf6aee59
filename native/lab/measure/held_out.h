// SPDX-License-Identifier: Apache-2.0
// Scores of a baked character against its capture: at the held-out cameras (straight-alpha ground truth pictures) and
// at the input cameras (video frames, with the backdrop removed from their matte's soft edges). Both pictures over
// black; the region is the union of both silhouettes (alpha >= 128). PSNR on RGB, SSIM on luma, see metrics.h; flicker,
// see FlickerScore. Memory: one frame of capture pictures and three pictures per sequence for the contact sheet.
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

struct ViewQuality {
  double psnr_db = kNotAsked, ssim = kNotAsked;  // over the union of the silhouettes
  double common_psnr_db = kNotAsked;             // over their intersection: without the outline's error
};

struct ViewScore {
  std::string sequence, camera;
  uint32_t frame = 0;
  bool held_out = true;  // false: an input camera
  ViewQuality ours = {}, yardstick = {};
};

// Held-out view of a sequence with the lowest SSIM. All RGB over black, of the camera's size.
struct WorstView {
  ViewScore score;
  Image truth, character, yardstick;  // yardstick may be empty
};

// Flicker between two consecutive pictures, drawn a frame period apart so that temporal filters run. NaN if no part of
// the surface is visible in both.
// At an input camera: change, on the surface, of the error against that camera's pictures (flickerLevels); these
// pictures are also in the layers.
// Camera kOrbit: change of the surface colours of frame 0 while the view turns from the first input camera by 1 degree
// per picture, for kOrbitPictures pictures. No captured picture is compared.
inline constexpr const char* kOrbit = "orbit";
inline constexpr uint32_t kOrbitPictures = 46;     // beyond one camera spacing of a ring of eight
inline constexpr uint32_t kMaxFlickerFrames = 64;  // per sequence, from frame 0
struct FlickerScore {
  std::string sequence, camera;
  uint32_t frame = 0;  // frame or picture of the orbit: the later of the two
  double levels = 0;
};
// Mean of the scores of this sequence and camera, excluding NaN; NaN without scores.
double meanFlicker(const std::vector<FlickerScore>& scores, const std::string& sequence, const std::string& camera);

struct HeldOutReport {
  std::vector<ViewScore> scores;
  std::vector<FlickerScore> flicker;
  std::vector<WorstView> worst;  // one per sequence with held-out views
};

// Requires a current GL context behind `character`. Calls `on_frame`, if set, after each finished frame of the capture.
// Errors: InvalidArgument (a sequence that capture or character lacks), and those of the capture and of the character.
Result<HeldOutReport> evaluateHeldOut(
    const capture::Capture& capture, const OpenVideo& open_video, edge::CharacterPlayer& character,
    const HeldOutOptions& options,
    const std::function<void(const std::string& sequence, uint32_t frame)>& on_frame = {});

// Means over the scores with these properties; an empty name matches any.
struct MeanViewScore {
  size_t views = 0;
  ViewQuality ours, yardstick;
};
MeanViewScore meanViewScore(const std::vector<ViewScore>& scores, bool held_out, const std::string& sequence,
                            const std::string& camera);

// Fixed-width table: per sequence and camera, means, worst views. Yardstick columns only if measured.
std::string scoreTable(const HeldOutReport& report);
std::string scoreCsv(const HeldOutReport& report);
// Rows: worst views; columns: truth, character, (yardstick,) absolute difference × 4. Cropped to the performer.
// `baseline` is the title of WorstView::yardstick.
Image contactSheet(const std::vector<WorstView>& worst, const std::string& baseline = "yardstick");

}  // namespace fourdvt::measure
