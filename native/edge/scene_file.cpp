// SPDX-License-Identifier: Apache-2.0
#include "edge/scene_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/hash.h"
#include "base/text.h"
#include "capture/capture.h"
#include "capture/text.h"
#include "platform/files.h"

namespace fourdvt::edge {
namespace {

using Json = nlohmann::json;
constexpr int kMaxSide = 8192, kMaxCharacters = 64;
constexpr double kMaxMetres = 1e5, kDegree_rad = 0.017453292519943295;

// Reads the members of JSON objects, rejects unknown ones, and keeps the first error.
class SceneReader {
 public:
  explicit SceneReader(const std::string& path) : path_(path), folder_(std::filesystem::path(path).parent_path()) {}

  Result<SceneFile> read(const Json& root) {
    SceneFile out;
    out.path = path_;
    known(root, "the scene",
          {"background", "camera", "camera_name", "metres_per_unit", "occluders", "meshes", "ground_y", "size", "fps",
           "seconds", "characters"});
    out.background = file(root, "background");
    for (const std::string& name : texts(root, "occluders")) out.occluders.push_back(inFolder(name));
    for (const std::string& name : texts(root, "meshes")) out.meshes.push_back(inFolder(name));
    out.ground_y_m = number(root, "ground_y", 0, -kMaxMetres, kMaxMetres);
    out.fps = number(root, "fps", 25, 1, 240);
    out.seconds = number(root, "seconds", 0, 0.001, 3600);
    if (root.contains("size")) {
      const std::vector<double> sides = numbers(root, "size", 2, 2, kMaxSide);
      if (ok()) out.size = {int(sides[0]), int(sides[1])};
    }
    readCharacters(root, out);
    if (!ok()) return problem_;
    if (const std::string cameras = file(root, "camera"); !cameras.empty())
      FOURDVT_TRY(readCameras(root, cameras, out));
    if (!ok()) return problem_;
    return out;
  }

 private:
  bool ok() const { return problem_.message.empty(); }
  void complain(const std::string& what) {
    if (ok()) problem_ = {ErrorId::InvalidArgument, path_ + ": " + what};
  }
  std::string inFolder(const std::string& name) const { return (folder_ / name).string(); }

  void known(const Json& node, const std::string& what, std::initializer_list<const char*> keys) {
    if (!node.is_object()) return complain(what + " must be a JSON object");
    for (const auto& [key, value] : node.items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        complain(what + " has no \"" + key + "\"; it may have " + joined(keys));
  }
  std::string text(const Json& node, const char* key) {
    if (!node.is_object() || !node.contains(key)) return {};
    if (node[key].is_string() && !node[key].get<std::string>().empty()) return node[key].get<std::string>();
    complain(std::string("\"") + key + "\" must be a text");
    return {};
  }
  std::string file(const Json& node, const char* key) {
    const std::string name = text(node, key);
    return name.empty() ? name : inFolder(name);
  }
  std::vector<std::string> texts(const Json& node, const char* key) {
    std::vector<std::string> out;
    if (!node.is_object() || !node.contains(key)) return out;
    bool good = node[key].is_array();
    for (const Json& entry : node[key]) {
      good = good && entry.is_string() && !entry.get<std::string>().empty();
      if (good) out.push_back(entry.get<std::string>());
    }
    if (!good) complain(std::string("\"") + key + "\" must be a list of texts");
    return out;
  }
  double checked(const Json& value, const std::string& key, double low, double high) {
    if (value.is_number() && value.get<double>() >= low && value.get<double>() <= high) return value.get<double>();
    const std::string range = printed(" from %g to %g", low, high);
    complain("\"" + key + "\" must be a number" + range);
    return low;
  }
  double number(const Json& node, const char* key, double otherwise, double low, double high) {
    return node.is_object() && node.contains(key) ? checked(node[key], key, low, high) : otherwise;
  }
  std::vector<double> numbers(const Json& node, const char* key, size_t count, double low, double high) {
    std::vector<double> out(count, 0.0);
    if (!node.is_object() || !node.contains(key)) return out;
    if (!node[key].is_array() || node[key].size() != count) {
      complain(std::string("\"") + key + "\" must be " + std::to_string(count) + " numbers");
      return out;
    }
    for (size_t i = 0; i < count; ++i) out[i] = checked(node[key][i], key, low, high);
    return out;
  }

  void readCharacters(const Json& root, SceneFile& out) {
    const Json none = Json::array(),
               &list = root.is_object() && root.contains("characters") ? root["characters"] : none;
    if (!list.is_array() || list.empty() || list.size() > size_t(kMaxCharacters))
      return complain("needs \"characters\", a list with 1 to " + std::to_string(kMaxCharacters) + " entries");
    for (const Json& node : list) {
      known(node, "a character", {"src", "state", "parameter", "position", "heading_deg", "travel", "play"});
      ActorOptions actor;
      actor.folder = file(node, "src");
      if (actor.folder.empty()) complain("a character needs \"src\", its folder");
      actor.state = text(node, "state");
      readParameters(node, actor);
      const std::vector<double> position = numbers(node, "position", 2, -kMaxMetres, kMaxMetres);
      actor.placement.ground_m = {position[0], position[1]};
      actor.placement.heading_rad = float(number(node, "heading_deg", 0, -3600, 3600) * kDegree_rad);
      if (node.is_object() && node.contains("travel")) {
        if (!node["travel"].is_boolean()) complain("\"travel\" must be true or false");
        actor.travel = node["travel"] == true;
      }
      for (const std::string& entry : texts(node, "play")) {
        const auto cue = parseCue(entry);
        if (!cue) complain("\"play\" must be a list of STATE@SECONDS, not \"" + entry + "\"");
        if (cue) actor.cues.push_back(*cue);
      }
      out.characters.push_back(std::move(actor));
    }
  }
  void readParameters(const Json& node, ActorOptions& actor) {
    if (!node.is_object() || !node.contains("parameter")) return;
    if (!node["parameter"].is_object()) return complain("\"parameter\" must be an object of names and numbers");
    for (const auto& [name, value] : node["parameter"].items())
      actor.parameters.emplace_back(name, checked(value, name, -1e6, 1e6));
  }

  // Cameras sorted by name, so that the track follows its numbered pictures.
  Status readCameras(const Json& root, const std::string& folder, SceneFile& out) {
    FOURDVT_ASSIGN(std::vector<capture::CaptureCamera> cameras, capture::readColmapCameras(folder));
    capture::scaleToMetres(cameras, number(root, "metres_per_unit", 1, 1e-6, 1e6));
    const std::string wanted = text(root, "camera_name");
    for (const auto& camera : cameras)
      if (wanted.empty() || camera.pinhole.name == wanted) out.cameras.push_back(camera.pinhole);
    if (out.cameras.empty()) complain(folder + " has no image \"" + wanted + "\"; correct \"camera_name\"");
    std::sort(out.cameras.begin(), out.cameras.end(),
              [](const PinholeCamera& a, const PinholeCamera& b) { return a.name < b.name; });
    return {};
  }

  std::string path_;
  std::filesystem::path folder_;
  Error problem_{ErrorId::InvalidArgument, ""};
};

}  // namespace

Result<SceneFile> readSceneFile(const std::string& path) {
  const auto text = capture::readText(path);
  if (!text) return Error{ErrorId::FileMissing, path + ": cannot be read; give the path of a scene's JSON file"};
  FOURDVT_ASSIGN(const Json root, capture::parseJsonText(*text, path, ErrorId::InvalidArgument));
  return SceneReader(path).read(root);
}

Result<std::vector<render::SceneCorner>> readSceneMesh(const std::string& path) {
  const auto content = capture::readText(path);
  if (!content) return Error{ErrorId::FileMissing, path + ": cannot be read; correct its path in the scene"};
  std::vector<render::SceneCorner> points, corners;
  capture::TextLines lines(*content, {.comment_behind = true, .continued = true});
  std::string_view line;
  const auto broken = [&](const std::string& what) {
    return Error{ErrorId::MeshIndex, capture::atLine(path, lines.number()) + what + "; export it again"};
  };
  while (lines.next(line)) {
    const std::string_view keyword = capture::takeWord(line);
    if (keyword == "v") {
      float v[6] = {0, 0, 0, 0.5f, 0.5f, 0.5f};
      int count = 0;
      for (; count < 6; ++count) {
        const std::string_view word = capture::takeWord(line);
        if (word.empty()) break;
        const auto value = capture::toNumber<float>(word);
        if (!value || !std::isfinite(*value)) return broken(capture::numberProblem(word));
        v[count] = *value;
      }
      if (count < 3) return broken("a vertex needs three numbers");
      points.push_back({{v[0], v[1], v[2]}, glm::vec3(0.5f)});
      if (count == 6) points.back().color = {v[3], v[4], v[5]};
    } else if (keyword == "f") {
      std::vector<size_t> polygon;
      for (std::string_view word = capture::takeWord(line); !word.empty(); word = capture::takeWord(line)) {
        const auto number = capture::toNumber<long>(word.substr(0, word.find('/')));
        const long index = !number ? 0 : *number < 0 ? long(points.size()) + *number + 1 : *number;
        if (index < 1 || index > long(points.size())) return broken("a face refers to a vertex that does not exist");
        polygon.push_back(size_t(index - 1));
      }
      for (size_t i = 2; i < polygon.size(); ++i)
        for (size_t corner : {polygon[0], polygon[i - 1], polygon[i]}) corners.push_back(points[corner]);
    }
  }
  if (corners.empty()) return broken("no faces in it");
  return corners;
}

Result<Image> readRoomPicture(const std::string& folder, const package::Room& room) {
  const std::string file = (std::filesystem::path(folder) / room.picture_uri).string();
  FOURDVT_ASSIGN(const auto bytes, platform::readFile(file));
  if (bytes.size() != room.picture_bytes || fnv1a(bytes) != room.picture_hash)
    return Error{ErrorId::FilesDiffer,
                 file + ": its bytes are not those that were baked with character.gltf; copy or bake it again"};
  FOURDVT_ASSIGN(const Image picture, platform::readImage(file));
  if (picture.width != room.width || picture.height != room.height)
    return Error{ErrorId::FileUnreadable, file + ": has another size than the manifest says; bake the character again"};
  if (picture.channels == 4) return picture;
  Image rgba(picture.width, picture.height, 4, 255);
  for (size_t i = 0; i < picture.pixels.size(); ++i) rgba.pixels[i / 3 * 4 + i % 3] = picture.pixels[i];
  return rgba;
}

Result<render::Scene> openRoom(gpu::Device& device, const std::string& manifest, const package::Character& character) {
  const package::Room& room = character.room;
  if (room.picture_uri.empty())
    return Error{ErrorId::InvalidArgument,
                 manifest + ": the character has no room; give \"room\" in capture.json and bake it again"};
  FOURDVT_ASSIGN(const Image picture, readRoomPicture(std::filesystem::path(manifest).parent_path().string(), room));
  render::Scene scene;
  FOURDVT_TRY(render::setRoom(device, room, scene));
  const gpu::TextureId texture = scene.room_picture.id();
  device.updateTexture(texture, {.width = room.width, .height = room.height}, picture.pixels.data());
  device.generateMipmaps(texture);
  scene.ground_y_m = static_cast<float>(character.ground_y_m);
  return scene;
}

}  // namespace fourdvt::edge
