// SPDX-License-Identifier: Apache-2.0
#include "capture/folder/linked_capture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "capture/capture_json.h"
#include "capture/mesh_file.h"
#include "platform/files.h"

namespace fourdvt::capture {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Status linkOne(const fs::path& from, const fs::path& to) {
  std::error_code failed, no_source, no_target;
  if (fs::exists(fs::symlink_status(to, failed))) return {};
  const fs::path source = fs::canonical(from, no_source), target = fs::canonical(to.parent_path(), no_target);
  if (no_source) return {};  // dangling link: no picture
  if (const fs::path relative = source.lexically_relative(target); !no_target && !relative.empty()) {
    fs::create_symlink(relative, to, failed);
    if (!failed) return {};
  }
  failed.clear();
  fs::copy(from, to, fs::copy_options::recursive, failed);
  if (!failed) return {};
  return Error{ErrorId::WriteFailed, to.string() + ": cannot be linked or copied from " + from.string() + ": " +
                                         failed.message() + "; check space and permissions"};
}

constexpr const char* kKeptCameras = "cameras_kept";  // folder of an own calibration

// Detects the report of an earlier command, which writing through a link would change.
bool isReport(const std::string& name) {
  for (const char* start :
       {"reconstruct.", "reconstruct-", "mattes.", "mattes-", "calibrate.", "calibrate-", "track.", "track-"})
    if (name.starts_with(start)) return true;
  return false;
}

// Returns true for a folder that has meshes and nothing else.
bool holdsMeshesAlone(const fs::path& folder) {
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed))
    if (!isMeshName(it->path().filename().string())) return false;
  return !failed;
}

// Returns true if an entry is the file of a pattern such as walk/%06d.obj, or the folder of such files.
bool hasPattern(const fs::path& entry, const fs::path& pattern) {
  if (entry == pattern.parent_path()) return holdsMeshesAlone(entry);
  const std::string name = entry.filename().string(), wanted = pattern.filename().string();
  const size_t begin = wanted.find('%'), end = wanted.find('d', begin);
  if (entry.parent_path() != pattern.parent_path() || end == std::string::npos) return entry == pattern;
  return name.starts_with(wanted.substr(0, begin)) && name.ends_with(wanted.substr(end + 1));
}

// Returns true if the entry of a sequence's folder, or of the capture's, belongs to its meshes, as named in
// capture.json or at their default place.
bool isMesh(const fs::path& entry, const fs::path& folder, const Json& sequence) {
  if (entry.filename() == kMeshFolder || entry == folder / kMeshTopology) return true;
  if (!sequence.is_object() || !sequence.contains("mesh")) return false;
  const auto named = [&](const Json& node) {
    return node.is_string() &&
           hasPattern(entry.lexically_normal(), (folder / node.get<std::string>()).lexically_normal());
  };
  const Json& mesh = sequence["mesh"];
  return named(mesh) ||
         (mesh.is_object() && (named(mesh.value("topology", Json())) || named(mesh.value("positions", Json()))));
}

Result<std::vector<fs::path>> entriesOf(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed))
    out.push_back(it->path());
  if (!failed) return out;
  return Error{ErrorId::FileMissing, folder.string() + ": cannot be listed: " + failed.message() +
                                         "; check that it is there and may be read"};
}

Status linkSequence(const fs::path& from, const fs::path& to, const Json& sequence, LinkedMeshes meshes) {
  const bool own_meshes = meshes != LinkedMeshes::AsGiven;
  const std::string name = sequence.value("name", "");
  FOURDVT_TRY(platform::makeFolder((to / name / (own_meshes ? kMeshFolder : "")).string()));
  FOURDVT_ASSIGN(const auto entries, entriesOf(from / name));
  for (const fs::path& entry : entries)
    if (!own_meshes || !isMesh(entry, from, sequence)) FOURDVT_TRY(linkOne(entry, to / name / entry.filename()));
  return {};
}

// Writes a text; a file that already has it stays unchanged, with its time.
Status writeText(const std::string& path, const std::string& text) {
  const auto found = platform::readText(path);
  if (found.ok() && found.value() == text) return {};
  return platform::writeFileAtomic(path, text);
}

void dropNames(const std::vector<std::string>& names, Json& by_camera) {
  if (!by_camera.is_object()) return;
  for (const std::string& name : names) by_camera.erase(name);
}

// Writes the calibration of the cameras in `capture`, and its path in capture.json.
Status writeKept(const Capture& capture, const std::string& to, const LinkOptions& options, Json& json) {
  if (options.leave_out.empty() && !options.own_calibration) return {};
  const std::string folder = to + "/" + kKeptCameras;
  FOURDVT_TRY(platform::makeFolder(folder));
  const ColmapText text = colmapText(capture.cameras, capture.metres_per_unit);
  FOURDVT_TRY(writeText(folder + "/cameras.txt", text.cameras));
  FOURDVT_TRY(writeText(folder + "/images.txt", text.images));
  json["calibration"]["ring"] = kKeptCameras;
  Json& calibration = json["calibration"];
  if (!calibration.contains("skew") || !calibration["skew"].is_object()) return {};
  dropNames(options.leave_out, calibration["skew"]);
  return {};
}

// Writes frame ranges. Remaining frames keep their pictures; held-out frames are renumbered from the new first frame.
void writeTimes(const CaptureSequence& sequence, Json& json) {
  const int64_t given = json.value("first_frame", int64_t(0)), later = int64_t(sequence.first_frame) - given;
  json["frames"] = sequence.frame_count;
  if (sequence.first_frame > 0) json["first_frame"] = sequence.first_frame;
  Json offsets = Json::object();
  for (const auto& [camera, frames] : sequence.offset_frames)
    if (frames != 0) offsets[camera] = std::round(1000 * frames) / 1000;
  json["offset_frames"] = std::move(offsets);
  if (!json.contains("test_frames") || !json["test_frames"].is_array()) return;
  Json tests = Json::array();
  for (const Json& frame : json["test_frames"]) {
    const int64_t now = frame.is_number_integer() ? frame.get<int64_t>() - later : -1;
    if (now >= 0 && now < int64_t(sequence.frame_count)) tests.push_back(now);
  }
  json["test_frames"] = std::move(tests);
}

void writeMotion(const CaptureSequence& sequence, double metres_per_unit, Json& json) {
  json["loop"] = sequence.loop;
  const glm::dvec3 v = sequence.root_velocity_mps / metres_per_unit;
  json.erase("root_velocity");
  if (v != glm::dvec3(0)) json["root_velocity"] = {v.x, v.y, v.z};
  json.erase("travel");
  if (!sequence.travel) return;
  const glm::dvec2 shift = sequence.travel->motion.shift_m / metres_per_unit,
                   place = sequence.travel->place_m / metres_per_unit;
  json["travel"] = {{"shift", {shift.x, shift.y}},
                    {"turn_deg", glm::degrees(sequence.travel->motion.turn_rad)},
                    {"place", {place.x, place.y}}};
}

void writeMeshes(const LinkOptions& options, Json& sequence) {
  const std::string folder = sequence.value("name", "") + "/" + kMeshFolder;
  if (options.meshes == LinkedMeshes::PerFrame) sequence["mesh"] = folder + "/%06d.ply";
  if (options.meshes == LinkedMeshes::Packed)
    sequence["mesh"] = {{"topology", kMeshTopology},
                        {"positions", folder + "/" + kPackedPositions},
                        {"units_per_metre", options.units_per_metre}};
}

void writeTopology(const LinkOptions& options, Json& json) {
  if (options.meshes == LinkedMeshes::AsGiven) return;
  json.erase("classes");
  if (options.meshes == LinkedMeshes::PerFrame) {
    json["topology"] = "per-frame";
    return;
  }
  json.erase("topology");
  if (!options.classes.empty()) json["classes"] = classesJson(options.classes);
}

}  // namespace

Status linkCapture(const Capture& capture, const std::string& to, const LinkOptions& options) {
  const std::string& from = capture.folder;
  std::ifstream file(from + "/capture.json");
  Json json = Json::parse(file, nullptr, false);
  if (!json.is_object() || !json.contains("sequences") || !json["sequences"].is_array())
    return Error{ErrorId::CaptureJson, from + "/capture.json: not valid JSON; see the sample capture's capture.json"};
  const auto nameOf = [](const Json& s) { return s.is_object() ? s.value("name", "") : std::string(); };
  std::vector<std::string> all;
  for (const Json& s : json["sequences"]) all.push_back(nameOf(s));

  const Json& listed = json["sequences"];
  FOURDVT_ASSIGN(const auto entries, entriesOf(from));
  for (const fs::path& entry : entries) {
    const std::string name = entry.filename().string();
    const bool of_meshes =
        options.meshes != LinkedMeshes::AsGiven &&
        std::any_of(listed.begin(), listed.end(), [&](const Json& s) { return isMesh(entry, from, s); });
    if (name == "capture.json" || of_meshes || isReport(name) || std::find(all.begin(), all.end(), name) != all.end())
      continue;
    if (name == kKeptCameras && (!options.leave_out.empty() || options.own_calibration)) continue;
    FOURDVT_TRY(linkOne(entry, fs::path(to) / name));
  }
  Json kept = Json::array();
  for (const Json& sequence : json["sequences"]) {
    if (std::find(options.sequences.begin(), options.sequences.end(), nameOf(sequence)) == options.sequences.end())
      continue;
    FOURDVT_TRY(linkSequence(from, to, sequence, options.meshes));
    kept.push_back(sequence);
    writeMeshes(options, kept.back());
    if (kept.back().contains("offset_frames")) dropNames(options.leave_out, kept.back()["offset_frames"]);
    const CaptureSequence* own = capture.find(nameOf(sequence));
    if (options.own_times && own) writeTimes(*own, kept.back());
    if (options.own_motion && own) writeMotion(*own, capture.metres_per_unit, kept.back());
  }
  if (json.contains("offset_frames")) dropNames(options.leave_out, json["offset_frames"]);
  if (options.own_times) json.erase("offset_frames");
  json["sequences"] = std::move(kept);
  writeTopology(options, json);
  FOURDVT_TRY(writeKept(capture, to, options, json));
  return writeText(to + "/capture.json", json.dump(2) + "\n");
}

Status leaveOut(const std::vector<std::string>& names, Capture& capture) {
  for (const std::string& name : names) {
    const auto at = std::find_if(capture.cameras.begin(), capture.cameras.end(),
                                 [&](const CaptureCamera& c) { return c.pinhole.name == name; });
    if (at == capture.cameras.end())
      return Error{ErrorId::InvalidArgument,
                   "--leave-out " + name + ": no camera of " + capture.cameras_folder + " has this name"};
    capture.cameras.erase(at);
    for (CaptureSequence& sequence : capture.sequences) sequence.offset_frames.erase(name);
  }
  if (!names.empty() && capture.cameras.size() < 2)
    return Error{ErrorId::InvalidArgument, "--leave-out: fewer than two cameras would be left; name fewer"};
  return {};
}

}  // namespace fourdvt::capture
