// SPDX-License-Identifier: Apache-2.0
#include "live/server/manifest_writer.h"

#include <nlohmann/json.hpp>

#include "package/character.h"

namespace fourdvt::live {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kLiveFormatVersion = 4;
constexpr size_t kLongestName = 128;  // bytes

Json rectJson(const package::Rect& r) { return {r.x, r.y, r.width, r.height}; }
Json pointJson(const glm::vec3& p) { return {p.x, p.y, p.z}; }

Json cameraJson(const PinholeCamera& camera) {
  Json matrix = Json::array();
  for (int i = 0; i < 16; ++i) matrix.push_back(camera.cam_from_world[i / 4][i % 4]);
  return {{"name", camera.name}, {"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},
          {"fy", camera.fy},     {"cx", camera.cx},       {"cy", camera.cy},         {"camFromWorld", matrix}};
}

}  // namespace

std::string liveManifest(const Rig& rig, const ManifestInput& input) {
  Json cameras = Json::array();
  for (const RigCamera& camera : rig.cameras) cameras.push_back(cameraJson(camera.camera.pinhole));
  const Json live = {
      {"session", input.session},
      {"fps", rig.fps},
      {"layout", {input.size.tiles.width, input.size.tiles.height}},
      {"codec", input.codec},
      {"width", input.size.width},
      {"height", input.size.height},
      {"tiles", rectJson(input.size.tiles)},
      {"barcode", {{"rect", rectJson(input.size.barcode.rect)}, {"cellSize", input.size.barcode.cell_size}}},
      {"origin", pointJson(rig.bounds.min)},
      {"step", kPositionStep_m}};
  const Json extension = {{"version", kLiveFormatVersion},
                          {"appearance", "cameras"},
                          {"name", rig.name.empty() ? "live" : rig.name.substr(0, kLongestName)},
                          {"vertexCount", kMostVertices},
                          {"faceCount", kMostFaces},
                          {"bounds", {{"min", pointJson(rig.bounds.min)}, {"max", pointJson(rig.bounds.max)}}},
                          {"groundY", rig.ground_y_m},
                          {"lengthScale", 1},
                          {"method", {{"name", "fvvr"}}},
                          {"cameras", cameras},
                          {"live", live}};
  return Json{{"asset", {{"version", "2.0"}}},
              {"extensionsUsed", {package::kExtensionName}},
              {"extensions", {{package::kExtensionName, extension}}}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace fourdvt::live
