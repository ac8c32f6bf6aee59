// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/held_out.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "lab/measure/appearance_score.h"
#include "lab/measure/held_out_truth.h"
#include "lab/measure/projective.h"
#include "mattes/frame_reader.h"
#include "measure/metrics.h"
#include "platform/files.h"

namespace fourdvt::measure {
namespace {

// Colour times alpha of a keyed camera picture: C = a·F + (1-a)·B, so a·F = C - (1-a)·B. Without a plate: a·C. Returns
// straight alpha, so that both kinds of truth have one format.
Image withoutBackdrop(const Image& rgba, const Image& plate) {
  if (plate.empty()) return rgba;
  Image out = rgba;
  for (size_t i = 0; i < static_cast<size_t>(rgba.width) * rgba.height; ++i) {
    const int alpha = rgba.pixels[4 * i + 3];
    if (alpha == 0 || alpha == 255) continue;
    for (int c = 0; c < 3; ++c) {
      const int backdrop = plate.pixels[static_cast<size_t>(plate.channels) * i + c];
      const int premultiplied = rgba.pixels[4 * i + c] - (255 - alpha) * backdrop / 255;
      out.pixels[4 * i + c] = static_cast<uint8_t>(std::clamp(premultiplied * 255 / alpha, 0, 255));
    }
  }
  return out;
}

constexpr float kStill = std::numeric_limits<float>::infinity();

class Evaluation {
 public:
  Evaluation(const capture::Capture& capture, edge::CharacterPlayer& character, const HeldOutOptions& options)
      : capture_(capture), character_(character), options_(options) {}

  Status prepare(bool any_held_out) {
    for (const auto& camera : capture_.cameras) cameras_.push_back(camera.pinhole);
    plates_.resize(cameras_.size());
    for (size_t c = 0; c < cameras_.size() && !capture_.background_folder.empty(); ++c) {
      auto plate = platform::readImage(capture_.background_folder + "/" + cameras_[c].name + ".png");
      if (!plate.ok() && plate.error().id == ErrorId::FileMissing) continue;  // mattes need no plate
      if (!plate.ok()) return plate.error();
      const bool fits = plate.value().width == cameras_[c].width && plate.value().height == cameras_[c].height;
      if (fits && !capture_.cameras[c].distortion.any()) plates_[c] = plate.take();
    }
    if (!any_held_out) return {};
    FOURDVT_ASSIGN(test_cameras_, capture::readTestCameras(capture_));
    return {};
  }

  Status frame(const capture::CaptureSequence& sequence, const mattes::CaptureFrame& input) {
    const auto& test = sequence.test_frames;
    if (std::find(test.begin(), test.end(), input.index) != test.end()) FOURDVT_TRY(heldOutViews(sequence, input));
    if (options_.input_every && input.index % options_.input_every == 0) FOURDVT_TRY(inputViews(sequence, input));
    return {};
  }

  // Runs after the scores: another view between two pictures would disturb temporal filters.
  Status flicker(const capture::CaptureSequence& sequence, const OpenVideo& open_video) {
    const size_t count = std::min<size_t>(options_.flicker_cameras, cameras_.size());
    if (count == 0 || capture_.meshes != capture::CaptureMeshes::ConstantTopology) return {};
    for (size_t c = 0; c < count; ++c) {
      FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(capture_, sequence, open_video));
      FOURDVT_TRY(flickerAt(sequence, c, *reader));
    }
    FOURDVT_ASSIGN(const Positions mesh, capture::readMeshFrame(capture_, sequence, 0));
    return flickerOnOrbit(sequence, mesh);
  }

  HeldOutReport take() { return std::move(report_); }

 private:
  Status flickerAt(const capture::CaptureSequence& sequence, size_t camera, mattes::FrameReader& reader) {
    const uint32_t count = std::min(sequence.frame_count, kMaxFlickerFrames);
    const PinholeCamera& view = bakedCamera(camera);
    TrueAndDrawn before;
    Positions mesh_before;
    for (uint32_t f = 0; f < count; ++f) {
      FOURDVT_ASSIGN(auto input, reader.next());
      FOURDVT_ASSIGN(auto drawn, draw(sequence.name, f, view, f == 0 ? kStill : float(1 / capture_.fps)));
      TrueAndDrawn now{withoutBackdrop(input.pictures[camera], plates_[camera]), std::move(drawn)};
      if (f > 0) addFlicker(sequence.name, view, view.name, f, before, now, mesh_before, input.positions);
      before = std::move(now);
      mesh_before = std::move(input.positions);
    }
    return {};
  }

  // Rotates the mesh in front of a fixed camera, equivalent to moving the camera round the mesh.
  Status flickerOnOrbit(const capture::CaptureSequence& sequence, const Positions& mesh) {
    const PinholeCamera& start = bakedCamera(0);
    const glm::dvec3 middle = boundsOf(mesh).middle();
    TrueAndDrawn before;
    Positions turned_before;
    for (uint32_t i = 0; i < kOrbitPictures; ++i) {
      const glm::dmat4 turn = glm::translate(
          glm::rotate(glm::translate(glm::dmat4(1), middle), glm::radians(double(i)), {0, 1, 0}), -middle);
      PinholeCamera view = start;
      view.cam_from_world = start.cam_from_world * turn;
      FOURDVT_ASSIGN(auto drawn, draw(sequence.name, 0, view, i == 0 ? kStill : float(1 / capture_.fps)));
      Positions turned;
      for (const glm::vec3& p : mesh) turned.emplace_back(turn * glm::dvec4(p, 1));
      Image black = drawn;  // silhouette only: the error is the colour
      for (size_t p = 0; p < black.pixels.size(); ++p)
        if (p % 4 < 3) black.pixels[p] = 0;
      TrueAndDrawn now{std::move(black), std::move(drawn)};
      if (i > 0) addFlicker(sequence.name, start, kOrbit, i, before, now, turned_before, turned);
      before = std::move(now);
      turned_before = std::move(turned);
    }
    return {};
  }

  Status heldOutViews(const capture::CaptureSequence& sequence, const mattes::CaptureFrame& input) {
    for (const PinholeCamera& camera : test_cameras_) {
      FOURDVT_ASSIGN(auto truth, heldOutTruth(sequence, camera, input.index));
      Image yardstick;
      const auto& faces = input.faces.empty() ? capture_.topology.face_vertices : input.faces;
      if (options_.yardstick) yardstick = renderProjective(camera, cameras_, input.pictures, faces, input.positions);
      FOURDVT_TRY(score({sequence.name, camera.name, input.index, true}, camera, truth, yardstick));
    }
    return {};
  }

  // Uses the character's cameras, which the bake may have refined.
  Status inputViews(const capture::CaptureSequence& sequence, const mattes::CaptureFrame& input) {
    for (size_t c = 0; c < cameras_.size(); ++c)
      FOURDVT_TRY(score({sequence.name, cameras_[c].name, input.index, false}, bakedCamera(c),
                        withoutBackdrop(input.pictures[c], plates_[c]), {}));
    return {};
  }

  const PinholeCamera& bakedCamera(size_t c) const {
    const auto& baked = character_.player().character()->cameras;
    const auto own = std::find_if(baked.begin(), baked.end(),
                                  [&](const PinholeCamera& camera) { return camera.name == cameras_[c].name; });
    return own == baked.end() ? cameras_[c] : *own;
  }

  Result<Image> draw(const std::string& sequence, uint32_t frame, const PinholeCamera& camera, float elapsed_s) {
    FOURDVT_TRY(character_.showFrame(sequence, frame));
    render::RecipeOptions recipe;
    recipe.ground_shadow = false;
    const auto scale = static_cast<float>(character_.player().character()->length_scale);
    return character_.renderStill(render::viewFromCamera(camera, {scale, scale}), recipe, nullptr, elapsed_s);
  }

  void addFlicker(const std::string& sequence, const PinholeCamera& view, const std::string& camera, uint32_t frame,
                  const TrueAndDrawn& before, const TrueAndDrawn& now, const Positions& mesh_before,
                  const Positions& mesh) {
    const FlowField motion = visibleMotion(view, capture_.topology.face_vertices, mesh_before, mesh);
    report_.flicker.push_back({sequence, camera, frame, flickerLevels(before, now, motion)});
  }

  // Fills in the score; its first four fields identify the picture.
  Status score(ViewScore score, const PinholeCamera& camera, const Image& truth, const Image& yardstick) {
    FOURDVT_ASSIGN(auto drawn, draw(score.sequence, score.frame, camera, kStill));
    WorstView view{std::move(score), compositedOnBlack(truth), compositedOnBlack(drawn), {}};
    const auto quality = [&](const Image& rgba, const Image& rgb) -> ViewQuality {
      const Mask inside = unionOfSilhouettes(truth, rgba);
      return {psnr(view.truth, rgb, inside), ssim(view.truth, rgb, inside),
              psnr(view.truth, rgb, commonSilhouette(truth, rgba))};
    };
    view.score.ours = quality(drawn, view.character);
    if (!yardstick.empty()) {
      view.yardstick = compositedOnBlack(yardstick);
      view.score.yardstick = quality(yardstick, view.yardstick);
    }
    report_.scores.push_back(view.score);
    if (view.score.held_out) keepIfWorst(std::move(view));
    return {};
  }

  void keepIfWorst(WorstView view) {
    for (WorstView& known : report_.worst) {
      if (known.score.sequence != view.score.sequence) continue;
      if (view.score.ours.ssim < known.score.ours.ssim) known = std::move(view);
      return;
    }
    report_.worst.push_back(std::move(view));
  }

  const capture::Capture& capture_;
  edge::CharacterPlayer& character_;
  const HeldOutOptions& options_;
  std::vector<PinholeCamera> cameras_, test_cameras_;
  std::vector<Image> plates_;  // empty if unavailable
  HeldOutReport report_;
};

// Last frame of the capture to decode.
uint32_t lastFrame(const capture::CaptureSequence& sequence, uint32_t input_every) {
  uint32_t last = 0;
  for (uint32_t frame : sequence.test_frames) last = std::max(last, frame);
  if (input_every) last = std::max(last, (sequence.frame_count - 1) / input_every * input_every);
  return last;
}

}  // namespace

Result<HeldOutReport> evaluateHeldOut(const capture::Capture& capture, const OpenVideo& open_video,
                                      edge::CharacterPlayer& character, const HeldOutOptions& options,
                                      const std::function<void(const std::string&, uint32_t)>& on_frame) {
  const package::Character* baked = character.player().character();
  if (!baked) return Error{ErrorId::Internal, "the character's manifest is not loaded"};
  std::vector<std::string> names = options.sequences;
  if (names.empty())
    for (const auto& sequence : baked->sequences)
      if (!sequence.isClass()) names.push_back(sequence.name);  // classes have no captured frames
  bool any_held_out = false;
  for (const std::string& name : names) {
    const capture::CaptureSequence* sequence = capture.find(name);
    if (!sequence) return Error{ErrorId::InvalidArgument, capture.folder + ": has no sequence \"" + name + "\""};
    if (!baked->find(name))
      return Error{ErrorId::InvalidArgument, "the character has no sequence \"" + name + "\"; bake it"};
    if (baked->find(name)->frame_count != sequence->frame_count)
      return Error{ErrorId::InvalidArgument,
                   "sequence \"" + name + "\" has another length in the capture than in the character; bake it again"};
    any_held_out |= !sequence->test_frames.empty();
  }
  Evaluation evaluation(capture, character, options);
  FOURDVT_TRY(evaluation.prepare(any_held_out));
  for (const std::string& name : names) {
    const capture::CaptureSequence& sequence = *capture.find(name);
    FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(capture, sequence, open_video));
    for (uint32_t frame = 0; frame <= lastFrame(sequence, options.input_every); ++frame) {
      FOURDVT_ASSIGN(auto input, reader->next());
      FOURDVT_TRY(evaluation.frame(sequence, input));
      if (on_frame) on_frame(name, frame);
    }
    FOURDVT_TRY(evaluation.flicker(sequence, open_video));
  }
  return evaluation.take();
}

}  // namespace fourdvt::measure
