// SPDX-License-Identifier: Apache-2.0
// COLMAP's text model: cameras.txt (intrinsics) and images.txt (poses, world to camera).
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <map>

#include "base/text.h"
#include "capture/capture.h"
#include "capture/colmap_model.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

Result<ColmapIntrinsics> parseModel(std::string_view line, const std::string& where) {
  Fields fields(line);
  const std::string name(fields.word());
  FOURDVT_ASSIGN(const ColmapModel* model, colmapModel(name, where));
  const int width = fields.number<int>(), height = fields.number<int>();
  std::array<double, kMaxColmapParameters> parameters{};
  for (int i = 0; i < model->parameters; ++i) parameters[i] = fields.number<double>();
  if (!fields.problem().empty()) {
    return colmapPoseError(where, name + " needs " + std::to_string(model->parameters) +
                                      " numbers behind width and height, but " + fields.problem());
  }
  return makeIntrinsics(*model, width, height, parameters.data(), where);
}

Result<std::map<int64_t, ColmapIntrinsics>> parseCameras(std::string_view text, const std::string& file) {
  std::map<int64_t, ColmapIntrinsics> cameras;
  TextLines lines(text);
  for (std::string_view line; lines.next(line);) {
    const auto id = toNumber<int64_t>(takeWord(line));
    const std::string where = atLine(file, lines.number());
    if (!id) return colmapPoseError(where, "the line must start with a camera number");
    FOURDVT_ASSIGN(cameras[*id], parseModel(line, where));
  }
  if (cameras.empty()) return colmapPoseError(file + ": ", "no camera in it");
  return cameras;
}

// Parses an image line behind its number: QW QX QY QZ TX TY TZ CAMERA_ID NAME, where NAME may contain blanks.
Result<ListedPicture> parseImage(std::string_view line, const std::map<int64_t, ColmapIntrinsics>& cameras,
                                 const std::array<double, 7>* by_rig, const std::string& where) {
  Fields fields(line);
  std::array<double, 7> pose{};
  for (double& value : pose) value = fields.number<double>();
  if (!fields.problem().empty()) {
    return colmapPoseError(where,
                           "the pose must be seven finite numbers (QW QX QY QZ TX TY TZ), but " + fields.problem());
  }
  const auto id = toNumber<int64_t>(fields.word());
  const auto found = id ? cameras.find(*id) : cameras.end();
  if (found == cameras.end())
    return colmapPoseError(where, "the image refers to a camera that cameras.txt does not list");
  FOURDVT_ASSIGN(auto camera, makeColmapCamera(found->second, by_rig ? *by_rig : pose, where));
  FOURDVT_TRY(checkListedPath(fields.rest(), where));
  return ListedPicture{std::move(camera), std::string(fields.rest()), where};
}

// Detects a POINTS2D line, which contains triples of numbers only; an image line ends in a name.
bool isPointsLine(std::string_view line) {
  size_t words = 0;
  for (std::string_view word = takeWord(line); !word.empty(); word = takeWord(line), ++words)
    if (!toNumber<double>(word)) return false;
  return words % 3 == 0;
}

// Smallest model for these coefficients, and the coefficients in its order behind fx fy cx cy.
std::pair<const char*, std::vector<double>> modelAndCoefficients(const Distortion& d) {
  if (d.fov != 0) return {"FOV", {d.fov}};
  if (d.fisheye && (d.p1 != 0 || d.p2 != 0 || d.sx1 != 0 || d.sy1 != 0))
    return {"THIN_PRISM_FISHEYE", {d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.sx1, d.sy1}};
  if (d.fisheye) return {"OPENCV_FISHEYE", {d.k1, d.k2, d.k3, d.k4}};
  if (d.k3 != 0 || d.k4 != 0 || d.k5 != 0 || d.k6 != 0)
    return {"FULL_OPENCV", {d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6}};
  if (d.k1 != 0 || d.k2 != 0 || d.p1 != 0 || d.p2 != 0) return {"OPENCV", {d.k1, d.k2, d.p1, d.p2}};
  return {"PINHOLE", {}};
}

std::vector<CaptureCamera> withoutPictures(const std::vector<ListedCamera>& listed) {
  std::vector<CaptureCamera> out;
  for (const ListedCamera& camera : listed) out.push_back(camera.camera);
  return out;
}

Result<std::string> readPart(const std::string& file) {
  auto text = readText(file);
  if (text) return std::move(*text);
  return Error{ErrorId::FileMissing, file +
                                         ": cannot be read; export the calibration as a COLMAP model, or run "
                                         "fourdvt import on what you have"};
}

}  // namespace

Result<std::vector<ListedPicture>> colmapTextPictures(std::string_view cameras_text, std::string_view images_text,
                                                      const RigPoses& rigs, const std::string& path) {
  FOURDVT_ASSIGN(auto intrinsics, parseCameras(cameras_text, path + "/cameras.txt"));
  const std::string file = path + "/images.txt";
  std::vector<ListedPicture> pictures;
  bool after_image = false;
  TextLines lines(images_text, {.blank_lines = true});
  for (std::string_view line; lines.next(line);) {
    const bool points = after_image && isPointsLine(line);
    after_image = false;
    const std::string_view first = takeWord(line);
    if (points || first.empty()) continue;
    const std::string where = atLine(file, lines.number());
    const auto id = toNumber<int64_t>(first);
    if (!id) return colmapPoseError(where, "the line must start with an image number");
    const auto by_rig = rigs.find(static_cast<uint64_t>(*id));
    FOURDVT_ASSIGN(pictures.emplace_back(),
                   parseImage(line, intrinsics, by_rig == rigs.end() ? nullptr : &by_rig->second, where));
    after_image = true;
  }
  if (pictures.empty()) return colmapPoseError(file + ": ", "no image in it");
  return pictures;
}

Result<std::vector<CaptureCamera>> parseColmapText(std::string_view cameras_text, std::string_view images_text,
                                                   const std::string& path) {
  FOURDVT_ASSIGN(const auto pictures, colmapTextPictures(cameras_text, images_text, {}, path));
  FOURDVT_ASSIGN(const auto listed, camerasOfPictures(pictures));
  return withoutPictures(listed);
}

Result<std::vector<CaptureCamera>> parseColmapBinary(std::string_view cameras_bytes, std::string_view images_bytes,
                                                     const std::string& path) {
  FOURDVT_ASSIGN(const auto pictures, colmapBinaryPictures(cameras_bytes, images_bytes, {}, path));
  FOURDVT_ASSIGN(const auto listed, camerasOfPictures(pictures));
  return withoutPictures(listed);
}

Result<std::vector<ListedCamera>> readColmapListed(const std::string& folder) {
  std::error_code ignored;
  const bool binary = !std::filesystem::exists(folder + "/cameras.txt", ignored) &&
                      std::filesystem::exists(folder + "/cameras.bin", ignored);
  const std::string ending = binary ? ".bin" : ".txt";
  FOURDVT_ASSIGN(const std::string cameras, readPart(folder + "/cameras" + ending));
  FOURDVT_ASSIGN(const std::string images, readPart(folder + "/images" + ending));
  RigPoses poses;
  if (const auto frames = readText(folder + "/frames" + ending)) {
    FOURDVT_ASSIGN(const std::string rigs, readPart(folder + "/rigs" + ending));
    FOURDVT_ASSIGN(poses, binary ? parseRigsBinary(rigs, *frames, folder) : parseRigsText(rigs, *frames, folder));
  }
  FOURDVT_ASSIGN(const auto pictures, binary ? colmapBinaryPictures(cameras, images, poses, folder)
                                             : colmapTextPictures(cameras, images, poses, folder));
  return camerasOfPictures(pictures);
}

Result<std::vector<CaptureCamera>> readColmapCameras(const std::string& folder) {
  FOURDVT_ASSIGN(const auto listed, readColmapListed(folder));
  return withoutPictures(listed);
}

void scaleToMetres(std::vector<CaptureCamera>& cameras, double metres_per_unit) {
  for (CaptureCamera& camera : cameras) {
    glm::dvec4& translation = camera.pinhole.cam_from_world[3];
    translation = glm::dvec4(glm::dvec3(translation) * metres_per_unit, 1);
  }
}

ColmapText colmapText(const std::vector<CaptureCamera>& cameras, double metres_per_unit) {
  ColmapText out{
      "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[] (PINHOLE: fx fy cx cy; OPENCV: and k1 k2 p1 p2; "
      "FULL_OPENCV: and k3 k4 k5 k6; OPENCV_FISHEYE: and k1 k2 k3 k4)\n",
      "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME / POINTS2D[] (empty)\n"};
  for (size_t c = 0; c < cameras.size(); ++c) {
    const PinholeCamera& p = cameras[c].pinhole;
    const auto [model, coefficients] = modelAndCoefficients(cameras[c].distortion);
    const glm::dquat q = glm::normalize(glm::quat_cast(glm::dmat3(p.cam_from_world)));
    const glm::dvec3 t = glm::dvec3(p.cam_from_world[3]) / metres_per_unit;
    out.cameras += printed("%zu %s %d %d %.9f %.9f %.9f %.9f", c + 1, model, p.width, p.height, p.fx, p.fy, p.cx, p.cy);
    for (const double coefficient : coefficients) out.cameras += printed(" %.12g", coefficient);
    out.cameras += "\n";
    out.images +=
        printed("%zu %.15f %.15f %.15f %.15f %.12f %.12f %.12f %zu ", c + 1, q.w, q.x, q.y, q.z, t.x, t.y, t.z, c + 1);
    const bool has_point = p.name.find('.') != std::string::npos;  // parts behind a dot would be removed as an
                                                                   // extension
    out.images += p.name + (has_point ? ".png\n\n" : "\n\n");
  }
  return out;
}

}  // namespace fourdvt::capture
