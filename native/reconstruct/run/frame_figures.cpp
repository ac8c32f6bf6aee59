// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/frame_figures.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace fourdvt::reconstruct {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::pair<const char*, std::vector<double> FrameFigures::*> kLists[] = {
    {"cover", &FrameFigures::cover},           {"overlap", &FrameFigures::overlap},
    {"outline_px", &FrameFigures::outline_px}, {"hull_overlap", &FrameFigures::hull_overlap},
    {"believed", &FrameFigures::believed},     {"moved", &FrameFigures::moved}};

}  // namespace

std::string figuresText(const FrameFigures& f) {
  Json out = {{"vertices", f.vertices},
              {"triangles", f.triangles},
              {"triangles_made", f.triangles_made},
              {"footprint_m", f.footprint_m},
              {"person_metre_m", f.person_metre_m},
              {"voxel_m", f.voxel_m},
              {"parts_left_out", f.parts_left_out},
              {"fallback", f.fallback},
              {"volume_m3", f.volume_m3},
              {"seen_m3", f.seen_m3},
              {"read_ms", f.read_ms},
              {"silhouettes_ms", f.silhouettes_ms},
              {"hull_ms", f.hull_ms},
              {"stereo_ms", f.stereo_ms},
              {"fairing_ms", f.fairing_ms},
              {"check_ms", f.check_ms}};
  for (const auto& [name, list] : kLists) {
    out[name] = Json::array();
    for (const double v : f.*list) out[name].push_back(std::isnan(v) ? Json() : Json(v));
  }
  return out.dump();
}

}  // namespace fourdvt::reconstruct
