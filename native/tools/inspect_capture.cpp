// SPDX-License-Identifier: Apache-2.0

#include <cstdio>
#include <filesystem>

#include "base/text.h"
#include "capture/capture.h"
#include "capture/mesh_sequence.h"
#include "capture/picture_report.h"
#include "tools/commands.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

std::string meshesOf(const std::string& folder) {
  const auto with = capture::openDescription(folder, {}, capture::MeshNeed::AnySurface);
  const bool none = !with.ok() && with.error().message.find(capture::kRunReconstruct) != std::string::npos;
  if (!with.ok()) return none ? "no meshes" : "meshes that cannot be used: " + with.error().message;
  return with.value().meshes == capture::CaptureMeshes::PerFrame ? "meshes of a topology per frame"
                                                                 : "meshes of constant topology";
}

// Prints one camera. Returns false if its pictures cannot be used, after printing the reason.
bool printCamera(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                 const capture::CaptureCamera& camera) {
  const auto report = capture::reportOnPictures(sequence, camera, videoOpener());
  const char* name = camera.pinhole.name.c_str();
  if (!report.ok()) {
    std::printf("  %-10s %s\n", name, report.error().message.c_str());
    return false;
  }
  const capture::PictureReport& r = report.value();
  std::string line = std::filesystem::path(r.path).lexically_relative(capture.folder).string() + ", " +
                     std::to_string(r.width) + "x" + std::to_string(r.height);
  if (r.pictures)
    line += ", " + std::to_string(*r.pictures) + " pictures" + (r.fps ? printed(" at %.4g/s", *r.fps) : "");
  if (!r.done.empty()) line += "; " + joined(r.done, "; ");
  std::printf("  %-10s %s; mattes: %s\n", name, line.c_str(),
              capture::matteSource(capture, sequence, camera, videoOpener()).c_str());
  const Status mattes = capture::checkMattes(sequence, camera, videoOpener());
  if (!mattes.ok()) std::printf("  %-10s %s\n", name, mattes.error().message.c_str());
  return mattes.ok();
}

}  // namespace

bool isCaptureFolder(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(std::filesystem::path(path) / "capture.json", ignored);
}

Result<int> inspectCapture(const std::string& folder) {
  FOURDVT_ASSIGN(const capture::Capture capture, capture::openDescription(folder, {}, capture::MeshNeed::Nothing));
  std::printf("%s: %s, %zu cameras, %g frames/s, %s\n", folder.c_str(), capture.name.c_str(), capture.cameras.size(),
              capture.fps, meshesOf(folder).c_str());
  size_t unusable = 0;
  for (const capture::CaptureSequence& sequence : capture.sequences) {
    std::printf("sequence %s: %u frames%s\n", sequence.name.c_str(), sequence.frame_count,
                sequence.loop ? ", a loop" : "");
    for (const capture::CaptureCamera& camera : capture.cameras) unusable += !printCamera(capture, sequence, camera);
  }
  if (unusable > 0) std::printf("%zu of the views cannot be used\n", unusable);
  return unusable > 0 ? kFailed : kOk;
}

}  // namespace fourdvt::tools
