// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/description.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace fourdvt::studio {
namespace {

using Json = nlohmann::ordered_json;

// Writes the later knobs only if set, so that captures without them keep their bytes.
Json knobsJson(const StudioKnobs& k) {
  Json out = {{"seed", k.seed},
              {"drift_mm", k.drift_mm},
              {"wrinkles", k.wrinkles},
              {"specular", k.specular},
              {"shading", k.shading},
              {"rotation_deg", k.rotation_deg},
              {"translation_mm", k.translation_mm},
              {"focal_percent", k.focal_percent},
              {"proxy_mm", k.proxy_mm},
              {"mesh_cell_mm", k.mesh_cell_mm},
              {"gain_percent", k.gain_percent},
              {"noise_levels", k.noise_levels},
              {"erosion_pixels", k.erosion_pixels}};
  const std::pair<const char*, double> later[] = {{"offset_frames", k.offset_frames},
                                                  {"soft_shadow_m", k.soft_shadow_m},
                                                  {"plate_move_pixels", k.plate_move_pixels},
                                                  {"exposure_drift_percent", k.exposure_drift_percent},
                                                  {"white_balance_drift_percent", k.white_balance_drift_percent}};
  for (const auto& [name, value] : later)
    if (value != 0) out[name] = value;
  if (k.plain) out["plain"] = true;
  if (k.plain_clothes) out["plain_clothes"] = true;
  if (k.lens != StudioKnobs().lens) out["lens"] = k.lens;
  return out;
}

// Rounds to millimetres of the actor's world, in units of the written one.
double rounded(double metres, double scale) { return std::round(1e3 * metres) / 1e3 * scale; }

Json rounded(const glm::dvec3& v, double scale) {
  Json out;
  for (int i = 0; i < 3; ++i) out.push_back(rounded(v[i], scale) + 0.0);  // no negative zero
  return out;
}

Json sequenceJson(const StudioSet& set, const StudioOptions& options, const Motion& motion) {
  const uint32_t count = filmedFrames(motion, options);
  const bool whole = count == frameCount(motion, options.fps);
  const glm::dvec3 v = options.scale * motion.root_velocity_mps;
  Json node = {{"name", motion.name}, {"frames", count}, {"loop", motion.loop && whole}};
  node["duration_s"] = whole ? motion.duration_s : count / options.fps;
  node["root_velocity"] = {v.x, v.y, v.z};
  node["video"] = motion.name + "/camNN" + (options.images ? "/%06d.png" : ".mp4");
  node[options.room ? "mask_without_error" : "mask"] =
      (options.room ? "mattes_true/" : "") + motion.name + "/maskNN" + (options.images ? "/%06d.png" : ".mkv");
  node["mesh"] = {{"topology", "mesh_topology.obj"},
                  {"positions", motion.name + "/mesh/positions.i16"},
                  {"units_per_metre", set.unitsPerMetre() / options.scale}};
  for (uint32_t frame = 0; frame < count; frame += options.test_every) node["test_frames"].push_back(frame);
  node["test_images"] = motion.name + "/testNN/%04d.png";
  return node;
}

}  // namespace

std::string captureText(const StudioSet& set, const StudioOptions& options, const Room* room) {
  Json root = {{"name", std::filesystem::path(options.folder).lexically_normal().filename().string()},
               {"kind", "virtual studio (rendered, not filmed)"},
               {"fps", options.fps},
               {"units", "metre"},
               {"up_axis", "Y"},
               {"handedness", "right"},
               {"facing", "+Z"},
               {"image_size", {options.width, options.height}},
               {"ground_y", rounded(set.groundY_m(), options.scale)}};
  for (const Motion& motion : set.actor().motions()) root["sequences"].push_back(sequenceJson(set, options, motion));
  for (const PinholeCamera& camera : set.rig().ring) root["cameras"].push_back(camera.name);
  for (const PinholeCamera& camera : set.rig().test) root["test_cameras"].push_back(camera.name);
  root["calibration"] = {{"format", set.lens().any() ? "COLMAP text" : "COLMAP text, PINHOLE"},
                         {"ring", "cameras/"},
                         {"ring_without_error", "cameras_true/"},
                         {"held_out", "cameras_test/"}};
  if (options.plates > 0)
    root["background"] = options.plates > 1 ? "background/camNN/%06d.png" : "background/camNN.png";
  for (const StudioClass& c : set.classes())
    root["classes"].push_back({{"name", c.name}, {"parameter", c.parameter}, {"members", c.members}});
  root["studio"] = {{"actor", std::filesystem::path(options.actor).filename().string()},
                    {"knobs", knobsJson(options.knobs)},
                    {"samples_a_pixel", 4}};
  if (options.scale != 1) root["studio"]["scale"] = options.scale;
  if (options.knobs.offset_frames != 0) root["studio"]["offset_frames_true"] = timeOffsets(options);
  if (room) {
    const BoundingBox box = room->box();
    if (options.plates > 0)
      root["room"] = {{"min", rounded(glm::dvec3(box.min), options.scale)},
                      {"max", rounded(glm::dvec3(box.max), options.scale)}};
    root["studio"]["room"] = {{"plates", options.plates}};
    if (options.bystander) root["studio"]["room"]["bystander"] = true;
    if (options.room_size_m > 0) root["studio"]["room"]["size_m"] = options.room_size_m;
  }
  if (options.truth_at.empty()) return root.dump(1) + "\n";
  for (const StudioClass& c : set.classes()) root["studio"]["truth"].push_back("truth/" + c.name + "/truth.json");
  return root.dump(1) + "\n";
}

}  // namespace fourdvt::studio
