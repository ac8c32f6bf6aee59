// SPDX-License-Identifier: Apache-2.0
#include "live/rig/rig.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "base/text.h"
#include "capture/pictures.h"
#include "capture/text.h"

namespace fourdvt::live {
namespace {

using Json = nlohmann::json;
constexpr double kMaxUnits = 1e6;
constexpr int kMinSide = 4, kMaxSide = 4095;  // side limits of pictures in messages, pixels
constexpr int kMaxReduction = 16;

const Json& member(const Json& node, const char* key) {
  static const Json null;
  if (!node.is_object()) return null;
  const auto it = node.find(key);
  return it == node.end() ? null : *it;
}

// True for addresses and devices, which are not resolved as files.
bool isAddress(const SourcePlace& place) {
  return place.url.find("://") != std::string::npos || !place.format.empty() || place.url.starts_with("/dev/");
}

class RigReader {
 public:
  explicit RigReader(const std::string& path) {
    rig_.path = path;
    rig_.folder = std::filesystem::path(path).parent_path().string();
    if (rig_.folder.empty()) rig_.folder = ".";
  }

  Result<Rig> read() {
    const auto text = capture::readText(rig_.path);
    if (!text || std::filesystem::is_directory(rig_.path))
      return Error{ErrorId::FileMissing,
                   rig_.path +
                       ": cannot be read; check the path, or write one, at least {\"fps\": 25} beside the "
                       "folders cameras and background"};
    const Json root = Json::parse(*text, nullptr, false);
    if (!root.is_object()) return error("is not a JSON object");
    FOURDVT_TRY(knownKeys(root));
    FOURDVT_ASSIGN(rig_.name, name(member(root, "name")));
    FOURDVT_TRY(scale(root));
    FOURDVT_TRY(cameras(member(root, "cameras")));
    FOURDVT_TRY(plates(member(root, "background")));
    FOURDVT_TRY(reduce(member(root, "reduce")));
    FOURDVT_TRY(bounds(member(root, "bounds")));
    FOURDVT_TRY(sources(member(root, "sources")));
    return std::move(rig_);
  }

 private:
  Error error(const std::string& what) const { return {ErrorId::CaptureJson, rig_.path + ": " + what}; }

  std::string inFolder(const std::string& path) const {
    return std::filesystem::path(path).is_absolute() ? path : rig_.folder + "/" + path;
  }

  Status knownKeys(const Json& root) const {
    static const std::set<std::string> known{"name",     "fps",    "units",  "cameras", "background",
                                             "ground_y", "bounds", "reduce", "sources"};
    for (const auto& [key, value] : root.items())
      if (!known.count(key))
        return error("unknown field \"" + key +
                     "\"; there are name, fps, units, cameras, background, ground_y, bounds, reduce and sources");
    return {};
  }

  Result<std::string> name(const Json& node) const {
    if (node.is_null()) return std::filesystem::absolute(rig_.folder).lexically_normal().filename().string();
    if (!node.is_string()) return error("\"name\" must be a text");
    return node.get<std::string>();
  }

  Status scale(const Json& root) {
    const Json &fps = member(root, "fps"), &units = member(root, "units"), &ground = member(root, "ground_y");
    if (!fps.is_number() || !(fps.get<double>() > 0) || fps.get<double>() > 1000)
      return error("needs \"fps\", a number above 0 and up to 1000");
    rig_.fps = fps.get<double>();
    const std::string unit = units.is_null() ? "metre" : units.is_string() ? units.get<std::string>() : "";
    metres_per_unit_ = unit == "metre" ? 1 : unit == "centimetre" ? 0.01 : unit == "millimetre" ? 0.001 : 0;
    if (metres_per_unit_ == 0) return error("\"units\" must be metre, centimetre or millimetre");
    if (ground.is_null()) return {};
    if (!ground.is_number() || !(std::abs(ground.get<double>()) <= kMaxUnits))
      return error("\"ground_y\" must be a number in the unit of \"units\", at most a million");
    rig_.ground_y_m = ground.get<double>() * metres_per_unit_;
    return {};
  }

  Result<std::string> folder(const Json& node, const char* key, const char* otherwise) const {
    if (!node.is_null() && !node.is_string())
      return error("\"" + std::string(key) + "\" must be a path, like \"" + otherwise + "\"");
    const std::string path = inFolder(node.is_null() ? otherwise : node.get<std::string>());
    if (std::filesystem::is_directory(path)) return path;
    return Error{ErrorId::FileMissing,
                 rig_.path + ": no folder " + path + "; correct \"" + key + "\" or add the folder"};
  }

  Status cameras(const Json& node) {
    FOURDVT_ASSIGN(cameras_folder_, folder(node, "cameras", "cameras"));
    FOURDVT_ASSIGN(auto cameras, capture::readColmapCameras(cameras_folder_));
    capture::scaleToMetres(cameras, metres_per_unit_);
    for (auto& c : cameras) {
      rig_.cameras.push_back({c, std::move(c), std::nullopt});
    }
    return {};
  }

  Status reduce(const Json& node) {
    if (!node.is_null() &&
        (!node.is_number_integer() || node.get<int64_t>() < 1 || node.get<int64_t>() > kMaxReduction))
      return error("\"reduce\" must be a whole number from 1 to " + std::to_string(kMaxReduction));
    if (!node.is_null()) rig_.reduce = node.get<int>();
    for (RigCamera& c : rig_.cameras) {
      PinholeCamera& used = c.camera.pinhole;
      used = reducedCamera(c.filmed.pinhole, rig_.reduce);
      c.camera.distortion.skew = c.filmed.distortion.skew / rig_.reduce;
      if (used.width > kMaxSide || used.height > kMaxSide || used.width < kMinSide || used.height < kMinSide)
        return Error{ErrorId::FrameSize, rig_.path + ": pictures of camera \"" + used.name + "\" have " +
                                             std::to_string(used.width) + "x" + std::to_string(used.height) +
                                             " pixels, and sides from " + std::to_string(kMinSide) + " to " +
                                             std::to_string(kMaxSide) + " can be used; correct \"reduce\""};
    }
    return {};
  }

  Status plates(const Json& node) {
    FOURDVT_ASSIGN(rig_.background_folder, folder(node, "background", "background"));
    for (const RigCamera& c : rig_.cameras) {
      const std::string stem = rig_.background_folder + "/" + c.camera.pinhole.name;
      std::string path = stem + ".png";
      for (const char* ending : {"/000000.png", "/000000.jpg"})
        if (!capture::isFile(path) && capture::isFile(stem + ending)) path = stem + ending;
      auto plate = capture::readCalibrated(path, 3, c.filmed);
      if (!plate.ok() && plate.error().id != ErrorId::FrameSize)
        return Error{plate.error().id, path + ": no readable picture of the empty stage, which camera \"" +
                                           c.camera.pinhole.name +
                                           "\" is keyed against; take one, or correct "
                                           "\"background\" in " +
                                           rig_.path};
      if (!plate.ok()) return plate.error();
    }
    return {};
  }

  Status bounds(const Json& node) {
    if (node.is_null()) {
      std::vector<capture::CaptureCamera> all;
      for (const RigCamera& c : rig_.cameras) all.push_back(c.camera);
      const auto box = commonView(all, rig_.ground_y_m);
      if (!box)
        return error(
            "no space is seen by all cameras; add \"bounds\": {\"min\": [x, y, z], \"max\": [x, y, z]} where "
            "the performer moves");
      rig_.bounds = *box;
      return {};
    }
    const auto corner = [&](const char* key, glm::vec3& out) {
      const Json& values = member(node, key);
      bool valid = values.is_array() && values.size() == 3;
      for (size_t i = 0; valid && i < 3; ++i) {
        valid = values[i].is_number() && std::abs(values[i].get<double>()) <= kMaxUnits;
        if (valid) out[static_cast<int>(i)] = float(values[i].get<double>() * metres_per_unit_);
      }
      return valid;
    };
    if (!corner("min", rig_.bounds.min) || !corner("max", rig_.bounds.max))
      return error("\"bounds\" must be {\"min\": [x, y, z], \"max\": [x, y, z]}, in the unit of \"units\"");
    if (!glm::all(glm::lessThan(rig_.bounds.min, rig_.bounds.max)))
      return error("\"bounds\" needs \"min\" below \"max\" on every axis");
    return {};
  }

  Status sources(const Json& node) {
    if (node.is_null()) return {};
    if (!node.is_object())
      return error("\"sources\" must be an object by camera, like {\"cam00\": \"videos/cam00.mp4\"}");
    for (const auto& [camera, entry] : node.items()) {
      const auto has_name = [name = camera](const RigCamera& c) { return c.camera.pinhole.name == name; };
      const auto it = std::find_if(rig_.cameras.begin(), rig_.cameras.end(), has_name);
      if (it == rig_.cameras.end())
        return error("\"sources\" names camera \"" + camera + "\", which " + cameras_folder_ + " has not; there are " +
                     names());
      FOURDVT_ASSIGN(it->source, source(camera, entry));
    }
    return {};
  }

  Result<std::optional<SourcePlace>> source(const std::string& camera, const Json& entry) const {
    if (entry.is_null()) return std::optional<SourcePlace>();
    SourcePlace place;
    const Json &open = entry.is_object() ? member(entry, "open") : entry, &format = member(entry, "format"),
               &options = member(entry, "options");
    if (!open.is_string() || open.get<std::string>().empty() || !(format.is_null() || format.is_string()) ||
        !(options.is_null() || options.is_object()))
      return error("source of \"" + camera +
                   "\" must be a path or address, or {\"open\": it, \"format\": a name, \"options\": {…}}, or null");
    place.url = open.get<std::string>();
    if (format.is_string()) place.format = format.get<std::string>();
    for (const auto& [key, value] : options.items()) {
      if (!value.is_string() && !value.is_number())
        return error("option \"" + key + "\" of the source of \"" + camera + "\" must be a text or a number");
      place.options[key] = value.is_string() ? value.get<std::string>() : value.dump();
    }
    if (isAddress(place)) return std::optional(place);
    place.url = inFolder(place.url);
    if (capture::isFile(place.url)) return std::optional(place);
    return Error{ErrorId::FileMissing,
                 rig_.path + ": source of \"" + camera + "\": no file " + place.url + "; correct \"sources\""};
  }

  std::string names() const {
    return joined(rig_.cameras, ", ", [](const RigCamera& c) { return c.camera.pinhole.name; });
  }

  Rig rig_;
  std::string cameras_folder_;
  double metres_per_unit_ = 1;
};

}  // namespace

capture::Capture Rig::asCapture() const {
  capture::Capture out;
  out.folder = folder;
  out.name = name;
  out.fps = fps;
  out.ground_y_m = ground_y_m;
  for (const RigCamera& c : cameras) out.cameras.push_back(c.filmed);
  out.background_folder = background_folder;
  out.meshes = capture::CaptureMeshes::None;
  return out;
}

const RigCamera* Rig::find(const std::string& camera) const {
  const auto it =
      std::find_if(cameras.begin(), cameras.end(), [&](const RigCamera& c) { return c.camera.pinhole.name == camera; });
  return it == cameras.end() ? nullptr : &*it;
}

Result<std::vector<Image>> readRigPlates(const Rig& rig, const RigCamera& camera, const std::string& otherwise) {
  FOURDVT_ASSIGN(auto plates, capture::readPlates(rig.asCapture(), camera.filmed, otherwise));
  if (rig.reduce == 1) return std::move(plates.pictures);
  std::vector<Image> out;
  for (Image& plate : plates.pictures) {
    const PinholeCamera& used = camera.camera.pinhole;
    Image& reduced = out.emplace_back(used.width, used.height, 3);
    const cv::Mat whole(plate.height, plate.width, CV_8UC3, plate.pixels.data());
    cv::Mat into(reduced.height, reduced.width, CV_8UC3, reduced.pixels.data());
    cv::resize(whole(cv::Rect(0, 0, used.width * rig.reduce, used.height * rig.reduce)), into, into.size(), 0, 0,
               cv::INTER_AREA);
  }
  return out;
}

Result<Rig> readRig(const std::string& path) { return RigReader(path).read(); }

namespace {

using Cameras = std::vector<capture::CaptureCamera>;

constexpr int kHalfCells = 48;        // cells of the grid from the middle, along each axis
constexpr double kMinDistance = 0.1;  // minimum depth of the box, relative to the farthest camera's distance

// Point of least squared distance from the cameras' principal rays.
glm::dvec3 meetingPoint(const Cameras& cameras) {
  glm::dmat3 sum(0.0);
  glm::dvec3 right(0.0), mean(0.0);
  for (const auto& c : cameras) {
    const glm::dvec3 along = c.pinhole.middleRayInWorld(), centre = c.pinhole.centreInWorld();
    const glm::dmat3 across = glm::dmat3(1.0) - glm::outerProduct(along, along);
    sum += across;
    right += across * centre;
    mean += centre / double(cameras.size());
  }
  // Falls back to the mean for parallel rays.
  return glm::determinant(sum) > 1e-9 ? glm::inverse(sum) * right : mean;
}

bool seenByAll(const Cameras& cameras, const glm::dvec3& point, double nearest_m) {
  return std::all_of(cameras.begin(), cameras.end(), [&](const auto& c) {
    const glm::dvec3 pixel = c.pinhole.project(point);
    return pixel.z >= nearest_m && pixel.x >= 0 && pixel.y >= 0 && pixel.x <= c.pinhole.width &&
           pixel.y <= c.pinhole.height;
  });
}

// Moves the nearest face of the box inwards for every camera inside the box or within the margin.
void keepCamerasOutside(const Cameras& cameras, const glm::dvec3& middle, double margin_m, glm::dvec3& low,
                        glm::dvec3& high) {
  for (const auto& c : cameras) {
    const glm::dvec3 at = c.pinhole.centreInWorld();
    if (glm::any(glm::lessThan(at, low - margin_m)) || glm::any(glm::greaterThan(at, high + margin_m))) continue;
    const glm::dvec3 off = at - middle, away = glm::abs(off);
    const int axis = away.x >= away.y && away.x >= away.z ? 0 : away.y >= away.z ? 1 : 2;
    if (off[axis] > 0)
      high[axis] = std::min(high[axis], at[axis] - margin_m);
    else
      low[axis] = std::max(low[axis], at[axis] + margin_m);
  }
}

}  // namespace

std::optional<BoundingBox> commonView(const Cameras& cameras, double ground_y_m) {
  if (cameras.empty()) return std::nullopt;
  const glm::dvec3 middle = meetingPoint(cameras);
  double reach_m = 0;
  for (const auto& c : cameras) reach_m = std::max(reach_m, glm::length(c.pinhole.centreInWorld() - middle));
  if (!(reach_m > 0)) return std::nullopt;
  const double cell_m = reach_m / kHalfCells, nearest_m = kMinDistance * reach_m;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (int z = -kHalfCells; z <= kHalfCells; ++z)
    for (int y = -kHalfCells; y <= kHalfCells; ++y)
      for (int x = -kHalfCells; x <= kHalfCells; ++x) {
        const glm::dvec3 point = middle + cell_m * glm::dvec3(x, y, z);
        if (point.y < ground_y_m - cell_m || !seenByAll(cameras, point, nearest_m)) continue;
        low = glm::min(low, point), high = glm::max(high, point);
      }
  if (!(low.x <= high.x)) return std::nullopt;
  low -= cell_m / 2, high += cell_m / 2;
  low.y = std::max(low.y, ground_y_m - 0.01 * (high.y - ground_y_m));
  keepCamerasOutside(cameras, middle, nearest_m, low, high);
  if (!glm::all(glm::lessThan(low, high))) return std::nullopt;
  return BoundingBox{glm::vec3(low), glm::vec3(high)};
}

}  // namespace fourdvt::live
