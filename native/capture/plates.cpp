// SPDX-License-Identifier: Apache-2.0
#include "capture/plates.h"

#include <filesystem>

#include "capture/mesh_sequence.h"
#include "capture/pictures.h"

namespace fourdvt::capture {
namespace {

constexpr uint32_t kMaxPlates = 100;  // more plates hardly improve the mean, and each takes memory while it is read

bool exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

// Paths of one file, or of the numbered ones; the expected path if there are none.
std::vector<std::string> platePaths(const std::string& stem) {
  if (exists(stem + ".png")) return {stem + ".png"};
  for (const char* extension : {".png", ".jpg"}) {
    std::vector<std::string> paths;
    while (paths.size() < kMaxPlates) {
      const std::string path = framePath(stem + "/%06d" + extension, static_cast<uint32_t>(paths.size()));
      if (!exists(path)) break;
      paths.push_back(path);
    }
    if (!paths.empty()) return paths;
  }
  return {stem + ".png"};
}

}  // namespace

Result<Plates> readPlates(const Capture& capture, const CaptureCamera& camera, const std::string& otherwise) {
  Plates out;
  for (const std::string& path : platePaths(capture.background_folder + "/" + camera.pinhole.name)) {
    if (out.path.empty()) out.path = path;
    auto plate = readCalibrated(path, 3, camera);
    if (!plate.ok() && plate.error().id == ErrorId::FrameSize) return plate.error();
    if (!plate.ok()) return Error{plate.error().id, path + ": " + otherwise};
    out.pictures.push_back(plate.take());
  }
  return out;
}

}  // namespace fourdvt::capture
