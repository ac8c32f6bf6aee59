// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/frame_figures.h"

#include <nlohmann/json.hpp>

namespace fourdvt::reconstruct {
namespace {

using Json = nlohmann::ordered_json;

// Calls `field` with the name and value of every figure.
template <class Figures, class Field>
void eachFigure(Figures& f, const Field& field) {
  field("vertices", f.vertices);
  field("triangles", f.triangles);
  field("triangles_made", f.triangles_made);
  field("footprint_m", f.footprint_m);
  field("person_metre_m", f.person_metre_m);
  field("voxel_m", f.voxel_m);
  field("parts_left_out", f.parts_left_out);
  field("fallback", f.fallback);
  field("volume_m3", f.volume_m3);
  field("seen_m3", f.seen_m3);
  field("read_ms", f.read_ms);
  field("silhouettes_ms", f.silhouettes_ms);
  field("hull_ms", f.hull_ms);
  field("stereo_ms", f.stereo_ms);
  field("fairing_ms", f.fairing_ms);
  field("check_ms", f.check_ms);
  field("cover", f.cover);
  field("overlap", f.overlap);
  field("outline_px", f.outline_px);
  field("hull_overlap", f.hull_overlap);
  field("believed", f.believed);
  field("moved", f.moved);
}

}  // namespace

std::string figuresText(const FrameFigures& f) {
  Json out;
  eachFigure(f, [&](const char* key, const auto& value) { out[key] = value; });
  return out.dump();  // NaN becomes null
}

}  // namespace fourdvt::reconstruct
