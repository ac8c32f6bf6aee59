// SPDX-License-Identifier: Apache-2.0
#include "bake/run/options.h"

#include "bake/run/renditions.h"
#include "encode/tile.h"

namespace fourdvt::bake {
namespace {

bool within(const std::optional<double>& length, double least, double most) {
  return !length || (*length >= least && *length <= most);
}

}  // namespace

std::string BakeOptions::check() const {
  if (capture_folder.empty()) return "no capture folder given";
  if (character_folder.empty()) return "no character folder given; use -o FOLDER";
  if (layers < 1 || layers > package::kMaxLayers)
    return "layers must be 1.." + std::to_string(package::kMaxLayers) + ", not " + std::to_string(layers);
  if (texture < 128 || texture % 32 != 0)
    return "texture must be a multiple of 32 from 128, not " + std::to_string(texture);
  if (const std::string wrong = encode::checkTileLayout(layers, texture, equal_layers); !wrong.empty()) return wrong;
  if (crf < 0 || crf > encode::infoOf(codec).highest_crf)
    return "crf must be 0.." + std::to_string(encode::infoOf(codec).highest_crf) + " for this codec, not " +
           std::to_string(crf);
  if (gop < 1 || gop > 250) return "gop must be 1..250 frames, not " + std::to_string(gop);
  if (jobs < 0) return "jobs must not be negative";
  if (survey_window_frames < 1) return "a window of the survey has at least one frame";
  if (!within(position_step_m, 1e-6, 0.1)) return "position step must be 0.001..100 mm";
  if (coarse_step_m != 0.0 && !within(coarse_step_m, 1e-6, 0.1)) return "coarse step must be 0, or 0.001..100 mm";
  if (!within(classes.blend_error_m, 1e-5, 1)) return "blend error must be 0.01..1000 mm";
  if (!within(classes.alignment_step_m, 1e-6, 0.1)) return "alignment step must be 0.001..100 mm";
  if (cameras.faces != 0 && (cameras.faces < 100 || cameras.faces > 1'000'000))
    return "faces must be 0, or 100..1000000";
  if (!(cameras.tile_scale >= 0.01 && cameras.tile_scale <= 1)) return "tile scale must be 0.01..1";
  if (!(cameras.max_texels >= 1e4)) return "tile texels must be 0.01 million or more";
  if (const std::string wrong = cameras.choice.check(); !wrong.empty()) return wrong;
  if (gutter_texels < 0 || gutter_texels > 64) return "gutter must be 0..64 texels";
  return checkRenditions(*this);
}

double gridStep_m(const BakeOptions& o) {
  const bool layers = o.appearance == package::AppearanceKind::Layers;
  return double(float(*o.position_step_m / (layers ? kGridPerStep : 1)));
}

}  // namespace fourdvt::bake
