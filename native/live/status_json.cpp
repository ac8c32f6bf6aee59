// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "live/service.h"

namespace fourdvt::live {
namespace {

using Json = nlohmann::json;

Json cameraJson(const PipelineStatus::CameraStatus& camera) {
  return {{"name", camera.name},
          {"connected", camera.connected},
          {"lost", camera.lost},
          {"pictures", camera.pictures},
          {"late", camera.late},
          {"keyed_ms", camera.keyed_ms},
          {"contour_bytes_per_s", camera.contour_bytes_per_s},
          {"picture_bytes_per_s", camera.picture_bytes_per_s},
          {"clock_offset_ms", camera.clock_offset_ms}};
}

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

std::string statusJson(const LiveStatus& status) {
  const PipelineStatus& p = status.pipeline;
  Json json{{"type", "status"},
            {"frames", p.frames},
            {"incomplete", p.incomplete},
            {"skipped", p.skipped},
            {"failed", p.failed},
            {"frames_per_s", p.frames_per_s},
            {"hull_ms", p.hull_ms},
            {"picture_ms", p.picture_ms},
            {"encode_ms", p.encode_ms},
            {"latency_ms", p.latency_ms},
            {"triangles", p.triangles},
            {"tolerance_px", p.tolerance_px},
            {"surface_bytes_per_s", p.surface_bytes_per_s},
            {"picture_bytes_per_s", p.picture_bytes_per_s},
            {"recorded", p.recorded},
            {"viewers", status.viewers.viewers},
            {"viewers_skipped", status.viewers.frames_skipped},
            {"viewers_bytes_per_s", status.viewers.bytes_per_s},
            {"refused", status.refused}};
  json["cameras"] = Json::array();
  for (const auto& camera : p.cameras) json["cameras"].push_back(cameraJson(camera));
  return dumped(json);
}

std::string pictureJson(const CameraPicture& picture, int width, int height) {
  Json rings = Json::array();
  for (const Ring16& ring : picture.rings) {
    Json points = Json::array();
    for (const Point16& p : ring) points.push_back(Json::array({p.x / kPointsPerPixel, p.y / kPointsPerPixel}));
    rings.push_back(std::move(points));
  }
  const package::Rect& crop = picture.crop;
  Json json;
  json["size"] = Json::array({width, height});
  json["crop"] = Json::array({crop.x, crop.y, crop.width, crop.height});
  json["rings"] = std::move(rings);
  json["number"] = picture.number;
  return dumped(json);
}

}  // namespace fourdvt::live
