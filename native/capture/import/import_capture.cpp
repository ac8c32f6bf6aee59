// SPDX-License-Identifier: Apache-2.0
#include "capture/import/import_capture.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

#include "base/text.h"
#include "capture/import/readers.h"
#include "capture/import/takes.h"
#include "platform/files.h"
#include "capture/pictures.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

namespace fs = std::filesystem;

constexpr double kAssumedFps = 25;
constexpr const char* kOnlyTake = "take";  // default sequence
constexpr double kLargeRig = 50;           // metres between cameras; larger rigs are probably not in metres

std::string shortNumber(double value) { return printed("%.6g", value); }

// Converts to metres, with Y up.
void turnAndScale(const glm::dmat3& turned_from_world, double metres_per_unit, ImportedCalibration& calibration) {
  for (ImportedCamera& imported : calibration.cameras) {
    glm::dmat4& pose = imported.camera.pinhole.cam_from_world;
    const glm::dvec3 translation = glm::dvec3(pose[3]) * metres_per_unit;
    pose = glm::dmat4(glm::dmat3(pose) * glm::transpose(turned_from_world));
    pose[3] = glm::dvec4(translation, 1);
  }
}

double widestDistance(const ImportedCalibration& calibration) {
  double widest = 0;
  for (const ImportedCamera& a : calibration.cameras) {
    for (const ImportedCamera& b : calibration.cameras) {
      widest = std::max(widest, glm::length(a.camera.pinhole.centreInWorld() - b.camera.pinhole.centreInWorld()));
    }
  }
  return widest;
}

void toMetresYUp(const ImportOptions& options, ImportedCalibration& calibration, ImportedMeshes meshes,
                 ImportSummary& summary) {
  const WorldAxis up = options.up.value_or(calibration.up.value_or(WorldAxis::Y));
  const double scale = options.metres_per_unit.value_or(calibration.metres_per_unit.value_or(1));
  turnAndScale(turnToY(up), scale, calibration);
  const std::string by_format = calibration.kind + " defines it";
  summary.done.push_back(up == WorldAxis::Y ? std::string("up is Y, the world is not turned")
                                            : std::string("the world is turned: ") + axisName(up) + " becomes Y" +
                                                  (options.up ? "" : " (" + by_format + ")"));
  if (!options.up && !calibration.up)
    summary.warnings.push_back(calibration.path + ": " + calibration.kind +
                               " defines no axis that is up; Y is assumed: else give --up");
  summary.done.push_back("one unit is " + shortNumber(scale) + " m" +
                         (options.metres_per_unit || !calibration.metres_per_unit ? "" : " (" + by_format + ")"));
  const double widest = widestDistance(calibration);
  const std::string apart = "cameras stand up to " + shortNumber(widest) + " m apart";
  summary.done.push_back(apart);
  if (!options.metres_per_unit && widest > kLargeRig)
    summary.warnings.push_back(calibration.path + ": " + apart + "; if the unit is a millimetre, give --scale 0.001");
  if (meshes != ImportedMeshes::None && (up != WorldAxis::Y || scale != 1))
    summary.warnings.push_back(
        "meshes are neither turned nor scaled, as the cameras were; export them in metres with "
        "Y up");
}

Status checkFolder(const ImportOptions& options) {
  std::error_code failed;
  for (const char* ending : {"", ".part"}) {
    const std::string path = options.folder + ending;
    if (!fs::exists(fs::symlink_status(path, failed)) || (fs::is_directory(path, failed) && fs::is_empty(path, failed)))
      continue;
    return Error{ErrorId::InvalidArgument, path + ": exists already; remove it, or choose another folder"};
  }
  return {};
}

// Folder of the source; empty: the current one.
fs::path baseOf(const ImportOptions& options) {
  const fs::path source = options.source;
  return isFolder(source) ? source : source.parent_path();
}

std::vector<Take> takesOf(const ImportOptions& options) {
  const fs::path base = baseOf(options);
  std::vector<Take> takes;
  for (const auto& [name, folder] : options.sequences) takes.push_back({name, (base / folder).string()});
  if (takes.empty()) takes.push_back({kOnlyTake, base.empty() ? "." : base.string()});
  for (Take& take : takes)
    take.loop = std::find(options.loops.begin(), options.loops.end(), take.name) != options.loops.end();
  return takes;
}

// Notes cameras whose names differ from their files'.
void noteNames(const ImportedCalibration& calibration, ImportSummary& summary) {
  std::string list;
  for (const ImportedCamera& imported : calibration.cameras) {
    const std::string& name = imported.camera.pinhole.name;
    if (name != imported.fileName()) list += (list.empty() ? "\"" : ", \"") + imported.fileName() + "\" is " + name;
  }
  if (!list.empty()) summary.done.push_back("names of files and cameras: " + list);
}

// Imports plates, from beside the calibration's pictures or from one of the takes.
Status importPlates(const ImportedCalibration& calibration, const std::vector<Take>& takes, const std::string& base,
                    const OpenVideo& open_video, const std::string& folder, ImportSummary& summary) {
  size_t found = 0;
  for (const ImportedCamera& imported : calibration.cameras) {
    const std::string& name = imported.camera.pinhole.name;
    std::optional<View> plates = findPlates(base, imported.fileName());
    for (const Take& take : takes)
      if (!plates) plates = findPlates(take.folder, imported.fileName());
    if (plates) FOURDVT_TRY(writePlates(*plates, imported.camera, open_video, folder));
    found += plates.has_value();
    if (!plates && !takes.front().mattes.count(name) && !takes.front().alphas.count(name))
      summary.warnings.push_back("camera " + name +
                                 ": no mattes and no plates of the empty studio (looked for CAMERA/background.png, "
                                 "background/CAMERA.png and the like); add some, or its clips alone have to show what "
                                 "is background");
  }
  summary.done.push_back("plates of " + std::to_string(found) + " cameras");
  return {};
}

// Adds a line per sequence and class, and one for the meshes.
void describeTakes(const ImportOptions& options, const std::vector<Take>& takes, ImportedMeshes meshes,
                   ImportSummary& summary) {
  for (const Take& take : takes) {
    const std::string with_meshes = take.meshes.empty() ? ""
                                    : take.hasOneMesh() ? ", one animated mesh"
                                                        : ", " + std::to_string(take.meshes.size()) + " meshes";
    const std::string alphas =
        take.alphas.empty() ? "" : ", " + std::to_string(take.alphas.size()) + " with mattes in their alpha";
    summary.done.push_back("sequence " + take.name + ": " + std::to_string(take.frames) + " frames" +
                           (take.loop ? ", a loop" : "") + ", " + std::to_string(take.mattes.size()) +
                           " cameras with mattes" + alphas + with_meshes);
  }
  if (meshes == ImportedMeshes::ConstantTopology) summary.done.push_back("meshes: one that moves, with UVs");
  if (meshes == ImportedMeshes::PerFrame)
    summary.done.push_back(
        "meshes: another topology in every frame, or no UVs; the character will be made from cameras");
  for (const CaptureClass& c : options.classes)
    summary.done.push_back("class " + c.name + " of " +
                           joined(c.members, ", ", [](const auto& member) { return member.sequence; }));
}

Status writeAll(const ImportOptions& options, const ImportedCalibration& calibration, std::vector<Take>& takes,
                ImportedMeshes meshes, double fps, const OpenVideo& open_video, ImportSummary& summary) {
  const std::string part = options.folder + ".part";
  FOURDVT_TRY(platform::makeFolder(part));
  for (Take& take : takes) {
    FOURDVT_TRY(linkTake(calibration, take, part));
    FOURDVT_TRY(findAlphas(calibration, part + "/" + take.name, open_video, take));
  }
  describeTakes(options, takes, meshes, summary);
  std::error_code failed;
  const std::string base = baseOf(options).string();
  FOURDVT_TRY(importPlates(calibration, takes, base.empty() ? "." : base, open_video, part, summary));
  FOURDVT_TRY(writeDescription(calibration, takes, meshes, options.classes, fps, part));
  fs::remove(options.folder, failed);  // removes an empty folder
  fs::rename(part, options.folder, failed);
  if (!failed) return {};
  return Error{ErrorId::WriteFailed, options.folder + ": " + failed.message() + "; choose another folder"};
}

}  // namespace

std::string ImportOptions::check() const {
  std::set<std::string> names;
  for (const auto& [name, path] : sequences) {
    const bool plain = !name.empty() && name[0] != '.' && name.find_first_of("/\\") == std::string::npos;
    if (!plain || path.empty()) return "--sequences must be NAME=FOLDER,NAME=FOLDER; a name is a plain folder name";
    if (!isUtf8(name)) return "--sequences: a name is not UTF-8; use letters and digits";
    if (name == "cameras" || name == "background") return "--sequences: \"" + name + "\" is a folder of every capture";
    if (!names.insert(name).second) return "--sequences names \"" + name + "\" twice";
  }
  std::vector<std::string> known;
  for (const auto& [name, path] : sequences) known.push_back(name);
  if (known.empty()) known.push_back(kOnlyTake);
  for (const std::string& name : loops)
    if (std::find(known.begin(), known.end(), name) == known.end())
      return "--loop: no sequence \"" + name + "\"; --sequences names them";
  if (!classes.empty() && known.size() < 2)
    return "--class joins sequences, and there is one; name them with --sequences NAME=FOLDER,NAME=FOLDER";
  return classProblem(classes, known, loops);
}

Result<ImportSummary> importCapture(const ImportOptions& given, const OpenVideo& open_video) {
  ImportOptions options = given;
  while (options.folder.size() > 1 && options.folder.back() == '/') options.folder.pop_back();
  FOURDVT_TRY(checkFolder(options));
  FOURDVT_ASSIGN(ImportedCalibration calibration, readCalibration(options.source));
  ImportSummary summary;
  summary.done.push_back(calibration.path + ": " + calibration.kind + ", " +
                         std::to_string(calibration.cameras.size()) + " cameras");
  summary.warnings = calibration.warnings;
  summary.details = calibration.details;
  std::vector<Take> takes = takesOf(options);
  findViews(calibration, takes);
  noteNames(calibration, summary);
  FOURDVT_TRY(keepSeenCameras(takes, calibration, summary.warnings));
  ViewMeasures measures{options.cropped, options.fps, options.orientation, !options.ignore_time_codes};
  ClipNotes notes;
  for (Take& take : takes) FOURDVT_TRY(measureViews(open_video, calibration, take, measures, notes));
  for (const std::string& line : joinedWarnings(notes.done)) summary.done.push_back(line);
  summary.warnings.insert(summary.warnings.end(), notes.warnings.begin(), notes.warnings.end());
  double fps = measures.fps;
  if (fps == 0) {
    fps = kAssumedFps;
    summary.warnings.push_back(takes.front().folder + ": pictures have no frame rate; " + shortNumber(fps) +
                               " frames a second are assumed: else give --fps");
  }
  FOURDVT_ASSIGN(const ImportedMeshes meshes, findMeshes(takes, summary.done, summary.warnings));
  toMetresYUp(options, calibration, meshes, summary);
  const Status written = writeAll(options, calibration, takes, meshes, fps, open_video, summary);
  if (!written.ok()) platform::removeFolder(options.folder + ".part");
  FOURDVT_TRY(written);
  summary.warnings = joinedWarnings(summary.warnings);
  return summary;
}

}  // namespace fourdvt::capture
