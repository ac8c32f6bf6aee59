// SPDX-License-Identifier: Apache-2.0
#include "capture/capture_json.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "capture/mesh_sequence.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

using Json = nlohmann::json;
constexpr double kMaxFrames = 10'000'000, kMaxUnits = 1e6, kMinUnitsPerMetre = 1e-3, kMaxOffset_ms = 1e8;
constexpr double kMaxTurn_deg = 359;

class Parser {
 public:
  explicit Parser(const std::string& folder) : folder_(folder), file_(folder + "/capture.json") {}

  Result<DeclaredCapture> parse(const Json& root) {
    if (!root.is_object()) return error("is not a JSON object");
    Capture& capture = out_.capture;
    capture.folder = folder_;
    capture.name = jsonText(jsonMember(root, "name"), std::filesystem::path(folder_).filename().string());
    capture.credit = jsonText(jsonMember(jsonMember(root, "licence"), "credit"));
    const Json& calibration = jsonMember(root, "calibration");
    if (!calibration.is_null() && !calibration.is_object())
      return error("\"calibration\" must be an object, like {\"ring\": \"cameras\"}");
    if (root.contains("orientation")) return error("\"orientation\" belongs into \"calibration\"");
    FOURDVT_ASSIGN(capture.cameras_folder,
                   inside("\"calibration\"", jsonText(jsonMember(calibration, "ring"), "cameras")));
    FOURDVT_TRY(skew(jsonMember(calibration, "skew")));
    FOURDVT_TRY(orientation(jsonMember(calibration, "orientation")));
    FOURDVT_TRY(background(jsonMember(root, "background")));
    FOURDVT_TRY(scale(root));
    FOURDVT_TRY(room(jsonMember(root, "room")));
    FOURDVT_TRY(topology(root));
    FOURDVT_TRY(offsets(jsonMember(root, "offset_frames"), offset_frames_));
    const Json& sequences = jsonMember(root, "sequences");
    if (!sequences.is_array() || sequences.empty()) return error("needs \"sequences\", a list with at least one entry");
    for (const Json& entry : sequences) FOURDVT_TRY(sequence(entry));
    FOURDVT_ASSIGN(capture.classes, parseClasses(jsonMember(root, "classes"), out_.sequences, file_));
    FOURDVT_TRY(footsteps(jsonMember(root, "classes")));
    return std::move(out_);
  }

 private:
  Error error(const std::string& what) const {
    return {ErrorId::CaptureJson, file_ + ": " + what + "; see the sample capture's capture.json"};
  }

  // Refuses paths outside the capture: a foreign capture must not name other files of its reader. Links in the folder
  // are followed: its owner made them.
  Result<std::string> inside(const std::string& what, const std::string& given) const {
    const std::filesystem::path path = std::filesystem::path(given).lexically_normal();
    if (!path.is_absolute() && (path.empty() || *path.begin() != "..")) return folder_ + "/" + given;
    return error(what + " leads out of the capture folder (" + given +
                 "): move the files inside, or link to them there");
  }

  // Reads numbers of at most `max` in size by camera; false for anything else.
  static bool readByCamera(const Json& node, double max, std::map<std::string, double>& out) {
    if (node.is_null()) return true;
    if (!node.is_object()) return false;
    for (const auto& [camera, number] : node.items()) {
      if (!number.is_number() || !(std::abs(number.get<double>()) <= max)) return false;
      out[camera] = number.get<double>();
    }
    return true;
  }

  // Skew, {"cam00": 0.3}, which COLMAP's models lack.
  Status skew(const Json& node) {
    if (readByCamera(node, kMaxUnits, out_.skew)) return {};
    return error("\"skew\" of \"calibration\" must be numbers by camera, in pixels, like {\"cam00\": 0.3}");
  }

  Status orientation(const Json& node) {
    const std::string kind = jsonText(node);
    if (kind == "marked") out_.orientation = Orientation::Marked;
    if (kind == "stored") out_.orientation = Orientation::Stored;
    if (node.is_null() || out_.orientation != Orientation::BySize) return {};
    return error(
        "\"orientation\" of \"calibration\" must be \"marked\" (of pictures as players show them) or \"stored\" (as "
        "they lie in the file)");
  }

  // Offsets, {"cam03": -1.5}, of the whole capture or of one sequence, which takes precedence.
  Status offsets(const Json& node, std::map<std::string, double>& out) const {
    if (readByCamera(node, kMaxFrames, out)) return {};
    return error("\"offset_frames\" must be numbers by camera, in frames, like {\"cam03\": -1.5}");
  }

  // Background: a path, or {"plates": path, "kind": "chroma" | "natural"}. The path is "FOLDER/camNN.png", or
  // "FOLDER/camNN/%06d.png" for several plates; only the folder is used.
  Status background(const Json& node) {
    const Json& given = node.is_object() ? jsonMember(node, "plates") : node;
    const Json& kind = jsonMember(node, "kind");
    const auto valid = [](const Json& j) { return j.is_null() || j.is_string(); };
    const std::string name = jsonText(kind);
    if (!valid(given) || !valid(kind) || !(kind.is_null() || name == "chroma" || name == "natural")) {
      return error(
          "\"background\" must be a path like \"background/camNN.png\", or {\"plates\": that path, \"kind\": "
          "\"chroma\" or \"natural\"}");
    }
    if (!kind.is_null()) {
      out_.capture.background_kind = name == "natural" ? BackgroundKind::Natural : BackgroundKind::Chroma;
    }
    const std::string plates = jsonText(given, "background/camNN.png");
    FOURDVT_ASSIGN(const std::string whole, inside("\"background\"", plates));
    const size_t camera = whole.rfind("/camNN/");
    const std::filesystem::path path = camera == std::string::npos ? whole : whole.substr(0, camera + 6);
    out_.capture.background_folder = path.parent_path().string();
    return {};
  }

  Status scale(const Json& root) {
    const Json& fps = jsonMember(root, "fps");
    if (!fps.is_number() || !(fps.get<double>() > 0) || fps.get<double>() > 1000) {
      return error("needs \"fps\", a number above 0");
    }
    out_.capture.fps = fps.get<double>();
    const std::string units = jsonText(jsonMember(root, "units"), "metre");
    if (units == "metre")
      out_.capture.metres_per_unit = 1;
    else if (units == "centimetre")
      out_.capture.metres_per_unit = 0.01;
    else if (units == "millimetre")
      out_.capture.metres_per_unit = 0.001;
    else
      return error("\"units\" must be metre, centimetre or millimetre, not \"" + units + "\"");
    if (jsonText(jsonMember(root, "up_axis"), "Y") != "Y")
      return error("\"up_axis\" must be Y: turn the cameras and meshes");
    const Json& ground = jsonMember(root, "ground_y");
    if (ground.is_number() && !(std::abs(ground.get<double>()) <= kMaxUnits))
      return error("\"ground_y\" must be at most a million");
    if (ground.is_number()) out_.capture.ground_y_m = ground.get<double>() * out_.capture.metres_per_unit;
    return {};
  }

  // Room, {"min": [x, y, z], "max": [x, y, z]}; requires the units.
  Status room(const Json& node) {
    if (node.is_null()) return {};
    BoundingBox box;
    const auto corner = [&](const char* key, glm::vec3& out) {
      glm::dvec3 place(0);
      const bool valid = jsonNumbers(jsonMember(node, key), 3, &place[0], kMaxUnits);
      out = glm::vec3(place * out_.capture.metres_per_unit);
      return valid;
    };
    if (!corner("min", box.min) || !corner("max", box.max))
      return error("\"room\" must be {\"min\": [x, y, z], \"max\": [x, y, z]}, in the unit of \"units\"");
    if (!glm::all(glm::lessThan(box.min, box.max))) return error("\"room\" needs \"min\" below \"max\" on every axis");
    out_.capture.room = box;
    return {};
  }

  Status topology(const Json& root) {
    const Json& node = jsonMember(root, "topology");
    const std::string kind = node.is_null() ? "constant" : jsonText(node);
    out_.per_frame = kind == "per-frame";
    if (kind == "constant" || kind == "per-frame") return {};
    return error("\"topology\" must be \"constant\" (one mesh that moves, with UVs) or \"per-frame\"");
  }

  Status sequence(const Json& node) {
    DeclaredSequence declared;
    CaptureSequence& sequence = declared.sequence;
    sequence.name = jsonText(jsonMember(node, "name"));
    if (sequence.name.empty() || sequence.name.find_first_of("/\\") != std::string::npos || sequence.name[0] == '.') {
      return error("every sequence needs a \"name\" that is a plain folder name");
    }
    if (!names_.insert(sequence.name).second) return error("sequence \"" + sequence.name + "\" is listed twice");
    const Json& frames = jsonMember(node, "frames");
    const double count = frames.is_number() ? frames.get<double>() : 0;
    if (!(count >= 1) || count > kMaxFrames || count != std::floor(count)) {
      return error("sequence \"" + sequence.name + "\" needs \"frames\", a whole number above 0");
    }
    sequence.frame_count = static_cast<uint32_t>(count);
    const Json& loop = jsonMember(node, "loop");
    if (!loop.is_null() && !loop.is_boolean())
      return error("\"loop\" of \"" + sequence.name + "\" must be true or false");
    sequence.loop = loop.is_boolean() && loop.get<bool>();
    sequence.folder = folder_ + "/" + sequence.name;
    const Json& first = jsonMember(node, "first_frame");
    if (!first.is_null() && !(first.is_number_unsigned() && first.get<uint64_t>() <= kMaxFrames))
      return error("\"first_frame\" of \"" + sequence.name + "\" must be a whole number, at least 0");
    if (!first.is_null()) sequence.first_frame = first.get<uint32_t>();
    sequence.offset_frames = offset_frames_;
    FOURDVT_TRY(offsets(jsonMember(node, "offset_frames"), sequence.offset_frames));
    FOURDVT_TRY(rootVelocity(node, sequence));
    FOURDVT_TRY(travel(jsonMember(node, "travel"), sequence));
    FOURDVT_TRY(testFrames(node, sequence));
    FOURDVT_ASSIGN(sequence.sound, sound("\"audio\" of \"" + sequence.name + "\"", jsonMember(node, "audio")));
    if (node.contains("mesh")) FOURDVT_TRY(mesh(node["mesh"], declared));
    out_.sequences.push_back(std::move(declared));
    return {};
  }

  // Sound: a path, or {"file": path, "offset_ms": number}.
  Result<std::optional<CaptureSound>> sound(const std::string& what, const Json& node) const {
    if (node.is_null()) return std::optional<CaptureSound>();
    const std::string file = jsonText(node.is_object() ? jsonMember(node, "file") : node);
    const Json& offset = jsonMember(node, "offset_ms");
    if (file.empty() || !(offset.is_null() || offset.is_number()) ||
        (offset.is_number() && !(std::abs(offset.get<double>()) <= kMaxOffset_ms)))
      return error(what + " must be a path like \"walk/sound.wav\", or {\"file\": that path, \"offset_ms\": 40}");
    CaptureSound out;
    FOURDVT_ASSIGN(out.path, inside(what, file));
    if (offset.is_number()) out.offset_s = offset.get<double>() / 1000;
    return std::optional(std::move(out));
  }

  // Reads "footsteps" of the classes, which must be objects.
  Status footsteps(const Json& classes) {
    for (CaptureClass& c : out_.capture.classes)
      for (const Json& node : classes) {
        if (jsonText(jsonMember(node, "name")) != c.name) continue;
        FOURDVT_ASSIGN(c.footstep, sound("\"footsteps\" of class \"" + c.name + "\"", jsonMember(node, "footsteps")));
      }
    return {};
  }

  Status rootVelocity(const Json& node, CaptureSequence& sequence) const {
    const Json& velocity = jsonMember(node, "root_velocity");
    if (velocity.is_null()) return {};
    if (!jsonNumbers(velocity, 3, &sequence.root_velocity_mps[0], kMaxUnits))
      return error("\"root_velocity\" of \"" + sequence.name + "\" must be three numbers");
    sequence.root_velocity_mps *= out_.capture.metres_per_unit;
    return {};
  }

  // Travel, {"shift": [x, z], "turn_deg": number, "place": [x, z]}; requires the units.
  Status travel(const Json& node, CaptureSequence& sequence) const {
    if (node.is_null()) return {};
    CaptureTravel out;
    const Json &turn = jsonMember(node, "turn_deg"), &place = jsonMember(node, "place");
    const bool valid = jsonNumbers(jsonMember(node, "shift"), 2, &out.motion.shift_m[0], kMaxUnits) &&
                       (turn.is_null() || jsonNumbers(Json::array({turn}), 1, &out.motion.turn_rad, kMaxTurn_deg)) &&
                       (place.is_null() || jsonNumbers(place, 2, &out.place_m[0], kMaxUnits));
    if (!valid)
      return error("\"travel\" of \"" + sequence.name +
                   "\" must be {\"shift\": [x, z], \"turn_deg\": 0, \"place\": [x, z]}, with less than a whole turn");
    out.motion.turn_rad = glm::radians(out.motion.turn_rad);
    out.motion.shift_m *= out_.capture.metres_per_unit;
    out.place_m *= out_.capture.metres_per_unit;
    sequence.travel = out;
    return {};
  }

  Status testFrames(const Json& node, CaptureSequence& sequence) const {
    const Json& frames = jsonMember(node, "test_frames");
    if (frames.is_null()) return {};
    bool valid = frames.is_array();
    for (size_t i = 0; valid && i < frames.size(); ++i) {
      valid = frames[i].is_number_unsigned() && frames[i].get<uint64_t>() < sequence.frame_count;
      if (valid) sequence.test_frames.push_back(frames[i].get<uint32_t>());
    }
    std::sort(sequence.test_frames.begin(), sequence.test_frames.end());  // videos are read forwards
    if (!valid) return error("\"test_frames\" of \"" + sequence.name + "\" must be frame numbers of the sequence");
    return {};
  }

  Status mesh(const Json& node, DeclaredSequence& declared) const {
    CaptureSequence& sequence = declared.sequence;
    const std::string where = "\"mesh\" of \"" + sequence.name + "\"";
    declared.without_meshes = node.is_null();
    if (node.is_null()) return {};
    if (!node.is_object()) {
      const std::string pattern = jsonText(node);
      FOURDVT_ASSIGN(sequence.mesh_pattern, inside(where, pattern));
      const std::string other = otherMeshKind(pattern);
      if (!other.empty()) {
        return Error{ErrorId::Unsupported, file_ + ": " + where + " (" + pattern + ") is " + other +
                                               ", which is not read; " + kExportReadable};
      }
      const bool may_be_all = sequence.frame_count == 1 || isGltfName(pattern);
      const bool one_file = may_be_all && !pattern.empty() && pattern.find('%') == std::string::npos;
      if (one_file || !framePath(sequence.mesh_pattern, 0).empty()) return {};
      return error(where + " must be a path with one %06d for the frame number, or of one animated .glb or .gltf");
    }
    if (out_.per_frame) return error(where + " must be a path: packed positions belong to constant topology");
    const std::string topology = jsonText(jsonMember(node, "topology")),
                      positions = jsonText(jsonMember(node, "positions"));
    const Json& units = jsonMember(node, "units_per_metre");
    if (topology.empty() || positions.empty() || !units.is_number() || !(units.get<double>() >= kMinUnitsPerMetre)) {
      return error(where + " needs \"topology\", \"positions\" and \"units_per_metre\" of at least 0.001");
    }
    FOURDVT_ASSIGN(declared.packed_topology, inside(where, topology));
    FOURDVT_ASSIGN(sequence.packed_positions, inside(where, positions));
    sequence.packed_units_per_metre = units.get<double>();
    return {};
  }

  std::string folder_, file_;
  DeclaredCapture out_;
  std::set<std::string> names_;
  std::map<std::string, double> offset_frames_;  // defaults of the whole capture
};

}  // namespace

Result<DeclaredCapture> parseCaptureJson(std::string_view text, const std::string& folder) {
  FOURDVT_ASSIGN(const Json root, parseJsonText(text, folder + "/capture.json", ErrorId::CaptureJson));
  return Parser(folder).parse(root);
}

}  // namespace fourdvt::capture
