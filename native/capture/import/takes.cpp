// SPDX-License-Identifier: Apache-2.0
#include "capture/import/takes.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "capture/picture_report.h"
#include "capture/pictures.h"
#include "capture/upright.h"

namespace fourdvt::capture {
namespace {

struct Measured {
  Image first;  // as it is stored
  PictureMarks marks;
  std::vector<std::string> conversions;
  uint64_t frames = 0;
  std::optional<double> fps;
};

// Containers of MPEG-4 and AVI count their pictures; the numbers of others are bounds.
bool countsItsFrames(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  return ending == ".mp4" || ending == ".mov" || ending == ".avi";
}

Result<Measured> measureVideo(const OpenVideo& open_video, const std::string& path) {
  FOURDVT_ASSIGN(auto video, open_video(path, 3));
  FOURDVT_ASSIGN(auto first, video->next());
  if (!first) return Error{ErrorId::FileUnreadable, path + ": no picture in it; export the video again"};
  Measured out{std::move(*first), video->marks(), video->conversions(), 1, video->framesPerSecond()};
  if (const auto hint = video->frameCountHint(); hint && countsItsFrames(path)) {
    out.frames = *hint;
    return out;
  }
  for (bool more = true; more; out.frames += more) {
    FOURDVT_ASSIGN(const auto next, video->next());
    more = next.has_value();
  }
  return out;
}

Result<Measured> measureView(const OpenVideo& open_video, const View& view) {
  if (!view.video.empty()) return measureVideo(open_video, view.video);
  Measured out{{}, {}, {}, view.pictures.size(), std::nullopt};
  FOURDVT_ASSIGN(out.first, readPicture(view.pictures.front(), 3, &out.marks));
  return out;
}

// Gives the camera the picture's size, which the calibration does not have or which differs by cropping.
Status takeSize(const Measured& measured, const std::string& path, CaptureCamera& camera) {
  PictureMarks marks;
  if (measured.marks.turns() && camera.orientation == Orientation::BySize)
    return orientationIsOpen(measured.marks, camera, path);
  if (camera.orientation == Orientation::Marked) marks = measured.marks, marks.pixel_aspect = 1;
  camera.pinhole.width = marks.swapsSides() ? measured.first.height : measured.first.width;
  camera.pinhole.height = marks.swapsSides() ? measured.first.width : measured.first.height;
  return {};
}

}  // namespace

void findViews(const ImportedCalibration& calibration, Take& take) {
  for (const ImportedCamera& imported : calibration.cameras) {
    const std::string& name = imported.camera.pinhole.name;
    std::optional<View> view;
    if (!imported.pictures.empty()) view = viewAt((std::filesystem::path(take.folder) / imported.pictures).string());
    if (!view) view = findView(take.folder, name);
    if (!view) continue;
    take.views[name] = *view;
    if (auto mattes = findMattes(take.folder, name)) take.mattes[name] = *mattes;
  }
}

Status keepSeenCameras(const std::vector<Take>& takes, ImportedCalibration& calibration,
                       std::vector<std::string>& warnings) {
  std::vector<std::string> names;
  for (const ImportedCamera& imported : calibration.cameras) names.push_back(imported.camera.pinhole.name);
  const auto unseen = [&](const ImportedCamera& imported) {
    const std::string& name = imported.camera.pinhole.name;
    for (const Take& take : takes) {
      if (take.views.count(name)) continue;
      warnings.push_back("camera " + name + " has no video and no pictures in " + take.folder +
                         "; the camera is left out");
      return true;
    }
    return false;
  };
  std::erase_if(calibration.cameras, unseen);
  for (const Take& take : takes) {
    std::vector<std::string> named;
    for (const auto& [name, view] : take.views) named.push_back(view.first());
    for (const std::string& path : viewsWithoutCamera(take.folder, names)) {
      const bool used = std::any_of(named.begin(), named.end(), [&](const auto& n) { return n.starts_with(path); });
      if (!used) warnings.push_back(path + ": no camera of the calibration has this name; it is left out");
    }
  }
  if (!calibration.cameras.empty()) return {};
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return Error{ErrorId::CameraMissingVideo,
               takes.front().folder + ": no video (CAMERA.mp4, .mkv, .mov, .avi, .webm) and no pictures (CAMERA/, " +
                   "CAMERA.png) of any of the cameras " + list + "; name them like the cameras"};
}

Result<Image> importedPicture(const Image& stored, const PictureMarks& marks, const CaptureCamera& camera,
                              const std::string& path) {
  auto picture = asCalibrated(stored, marks, camera, path);
  const PinholeCamera& p = camera.pinhole;
  const bool smaller = stored.width <= p.width && stored.height <= p.height;
  if (picture.ok() || !smaller || (stored.width == p.width && stored.height == p.height)) return picture;
  return Error{
      picture.error().id,
      picture.error().message + ", or give --cropped if they only lack columns at the right or rows at the bottom"};
}

Status measureViews(const OpenVideo& open_video, ImportedCalibration& calibration, Take& take, ViewMeasures& measures,
                    std::vector<std::string>& warnings) {
  double& fps = measures.fps;
  uint64_t fewest = UINT32_MAX, most = 0;
  std::string shortest;
  for (ImportedCamera& imported : calibration.cameras) {
    const PinholeCamera& pinhole = imported.camera.pinhole;
    const View& view = take.views.at(pinhole.name);
    FOURDVT_ASSIGN(const Measured measured, measureView(open_video, view));
    const bool smaller = measured.first.width <= pinhole.width && measured.first.height <= pinhole.height;
    imported.camera.orientation = measures.orientation;
    if (pinhole.width == 0 || (measures.cropped && smaller))
      FOURDVT_TRY(takeSize(measured, view.first(), imported.camera));
    const auto picture = importedPicture(measured.first, measured.marks, imported.camera, view.first());
    if (!picture.ok()) return picture.error();
    auto done = describeMarks(measured.marks, measured.first, picture.value(), imported.camera);
    done.insert(done.end(), measured.conversions.begin(), measured.conversions.end());
    for (const std::string& what : done) measures.done[what].insert(pinhole.name);
    if (fps == 0 && measured.fps) fps = *measured.fps;
    if (measured.fps && std::abs(*measured.fps - fps) > 0.01 * fps) {
      warnings.push_back(view.video + ": its container says " + std::to_string(*measured.fps) + " frames a second; " +
                         std::to_string(fps) + " are written");
    }
    if (measured.frames < fewest) fewest = measured.frames, shortest = view.first();
    most = std::max(most, measured.frames);
  }
  take.frames = static_cast<uint32_t>(fewest);
  if (fewest < most) {
    warnings.push_back(shortest + ": the shortest, with " + std::to_string(fewest) + " frames; others have up to " +
                       std::to_string(most));
  }
  return {};
}

}  // namespace fourdvt::capture
