// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/frame_figures.h"

#include <cmath>
#include <limits>
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

Result<FrameFigures> parseFigures(const std::string& text, const std::string& path) {
  const Json json = Json::parse(text, nullptr, false);
  const Error damaged{ErrorId::FileUnreadable, path + ": damaged; run the command without --resume"};
  if (!json.is_object() || !json.contains("overlap") || !json["overlap"].is_array()) return damaged;
  FrameFigures f;
  const auto number = [&](const char* key) {
    const auto it = json.find(key);
    return it != json.end() && it->is_number() ? it->get<double>() : 0.0;
  };
  f.vertices = uint32_t(number("vertices"));
  f.triangles = uint32_t(number("triangles"));
  f.triangles_made = uint32_t(number("triangles_made"));
  f.footprint_m = number("footprint_m");
  f.person_metre_m = number("person_metre_m");
  f.voxel_m = number("voxel_m");
  f.parts_left_out = uint32_t(number("parts_left_out"));
  f.volume_m3 = number("volume_m3");
  f.seen_m3 = number("seen_m3");
  f.fallback = json.value("fallback", "");
  for (const auto& [name, list] : kLists) {
    const auto values = json.find(name);  // frames of an earlier version lack some
    if (values == json.end() || !values->is_array()) continue;
    for (const Json& v : *values)
      (f.*list).push_back(v.is_number() ? v.get<double>() : std::numeric_limits<double>::quiet_NaN());
  }
  f.read_ms = number("read_ms");
  f.silhouettes_ms = number("silhouettes_ms");
  f.hull_ms = number("hull_ms");
  f.stereo_ms = number("stereo_ms");
  f.fairing_ms = number("fairing_ms");
  f.check_ms = number("check_ms");
  return f;
}

}  // namespace fourdvt::reconstruct
