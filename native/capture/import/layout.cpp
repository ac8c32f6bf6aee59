// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "capture/capture_json.h"
#include "capture/import/takes.h"
#include "capture/mesh_sequence.h"
#include "capture/pictures.h"
#include "capture/text.h"
#include "capture/upright.h"
#include "platform/files.h"

namespace fourdvt::capture {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxDecodedPlates = 25;  // more than ten hardly change the statistics

// Makes a relative link, so that both folders can be moved together.
Status linkFile(const fs::path& from, const fs::path& to) {
  std::error_code failed;
  const fs::path source = fs::canonical(from, failed);
  const fs::path folder = failed ? fs::path() : fs::canonical(to.parent_path(), failed);
  if (!failed) fs::create_symlink(source.lexically_relative(folder), to, failed);
  if (!failed) return {};
  return Error{ErrorId::WriteFailed, to.string() + ": cannot be linked to " + from.string() + ": " + failed.message() +
                                         "; choose a folder on a disk that has links"};
}

// Links pictures. Readers open .png and .jpg by content, and require number 0, so that the first picture also replaces
// earlier ones, which are not read.
Status linkPictures(const View& view, const std::string& folder) {
  FOURDVT_TRY(platform::makeFolder(folder));
  const std::string first = lowerExtension(view.pictures.front());
  const std::string ending = first == ".jpg" || first == ".jpeg" ? ".jpg" : ".png";
  const size_t end = view.first_number + view.pictures.size();
  for (size_t i = 0; i < end; ++i)
    FOURDVT_TRY(linkFile(view.pictures[i < view.first_number ? 0 : i - view.first_number],
                         framePath(folder + "/%06d" + ending, static_cast<uint32_t>(i))));
  return {};
}

Status linkView(const View& view, const std::string& stem) {
  if (view.video.empty()) return linkPictures(view, stem);
  return linkFile(view.video, stem + lowerExtension(view.video));
}

// Step between the pictures used as plates.
uint64_t plateStep(uint64_t frames) {
  return std::max<uint64_t>(1, (frames + kMaxDecodedPlates - 1) / kMaxDecodedPlates);
}

}  // namespace

Status linkTake(const ImportedCalibration& calibration, const Take& take, const std::string& folder) {
  const std::string own = folder + "/" + take.name;
  FOURDVT_TRY(platform::makeFolder(own));
  for (const ImportedCamera& imported : calibration.cameras) {
    const std::string& name = imported.camera.pinhole.name;
    FOURDVT_TRY(linkView(take.views.at(name), own + "/" + name));
    if (const auto mattes = take.mattes.find(name); mattes != take.mattes.end())
      FOURDVT_TRY(linkView(mattes->second, own + "/" + matteStem(name)));
  }
  if (!take.meshes.empty()) FOURDVT_TRY(platform::makeFolder(own + "/mesh"));
  if (take.hasOneMesh()) return linkFile(take.meshes[0], own + "/mesh/take" + lowerExtension(take.meshes[0]));
  for (size_t f = 0; f < take.meshes.size(); ++f) {
    const std::string name = framePath(own + "/mesh/%06d", take.first_frame + static_cast<uint32_t>(f));
    FOURDVT_TRY(linkFile(take.meshes[f], name + lowerExtension(take.meshes[f])));
  }
  return {};
}

Status writePlates(const View& plates, const CaptureCamera& camera, const OpenVideo& open_video,
                   const std::string& folder) {
  const std::string own = folder + "/background/" + camera.pinhole.name;
  if (plates.video.empty()) {
    PictureMarks marks;
    FOURDVT_ASSIGN(const Image first, readPicture(plates.first(), 3, &marks));
    if (const auto fits = importedMarks(first, marks, camera, plates.first()); !fits.ok()) return fits.error();
    return linkPictures(plates, own);
  }
  FOURDVT_TRY(platform::makeFolder(own));
  FOURDVT_ASSIGN(auto video, open_video(plates.video, 3));
  FOURDVT_ASSIGN(const VideoListing listing, video->list());
  const uint64_t step = plateStep(listing.pictures);
  uint32_t written = 0;
  for (uint64_t frame = 0; written < kMaxDecodedPlates; ++frame) {
    FOURDVT_ASSIGN(std::optional<Image> picture, video->next());
    if (!picture) break;
    if (frame % step != 0) continue;
    FOURDVT_ASSIGN(const PictureMarks marks, importedMarks(*picture, video->marks(), camera, plates.video));
    FOURDVT_TRY(platform::writeImage(framePath(own + "/%06d.png", written++), applyMarks(std::move(*picture), marks)));
  }
  if (written > 0) return {};
  return Error{ErrorId::FileUnreadable, plates.video + ": no picture in it; export the clip again"};
}

Status writeDescription(const ImportedCalibration& calibration, const std::vector<Take>& takes, ImportedMeshes meshes,
                        const std::vector<CaptureClass>& classes, double fps, const std::string& folder) {
  std::vector<CaptureCamera> cameras;
  nlohmann::ordered_json json{{"fps", fps}, {"units", "metre"}, {"up_axis", "Y"}, {"ground_y", 0}};
  json["calibration"]["ring"] = "cameras";
  for (const ImportedCamera& imported : calibration.cameras) {
    cameras.push_back(imported.camera);
    if (const double skew = imported.camera.distortion.skew; skew != 0)
      json["calibration"]["skew"][imported.camera.pinhole.name] = skew;
  }
  if (const auto orientation = calibration.cameras.front().camera.orientation; orientation != Orientation::BySize)
    json["calibration"]["orientation"] = orientation == Orientation::Marked ? "marked" : "stored";
  if (meshes == ImportedMeshes::PerFrame) json["topology"] = "per-frame";
  for (const Take& take : takes) {
    nlohmann::ordered_json sequence{{"name", take.name}, {"frames", take.frames}};
    if (take.loop) sequence["loop"] = true;
    if (take.first_frame > 0) sequence["first_frame"] = take.first_frame;
    for (const auto& [camera, frames] : take.offset_frames) sequence["offset_frames"][camera] = frames;
    json["sequences"].push_back(std::move(sequence));
  }
  if (!classes.empty()) json["classes"] = classesJson(classes);
  const ColmapText text = colmapText(cameras, 1);
  FOURDVT_TRY(platform::makeFolder(folder + "/cameras"));
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/cameras/cameras.txt", text.cameras));
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/cameras/images.txt", text.images));
  return platform::writeFileAtomic(folder + "/capture.json", json.dump(2) + "\n");
}

}  // namespace fourdvt::capture
