// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <set>

#include "base/text.h"
#include "capture/colmap_model.h"
#include "capture/import/readers.h"
#include "capture/pictures.h"
#include "capture/text.h"
#include "platform/files.h"

namespace fourdvt::capture {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxCalibrationBytes = 64 << 20;

Status checkBytes(const fs::path& path) {
  if (platform::fileBytes(path.string()) <= kMaxCalibrationBytes) return {};
  return Error{ErrorId::FileUnreadable,
               path.string() + ": larger than 64 MB, which no calibration is; name the calibration file"};
}

Result<std::string> readSmall(const fs::path& path) {
  FOURDVT_TRY(checkBytes(path));
  FOURDVT_ASSIGN(const auto bytes, platform::readFile(path.string()));
  return std::string(skipByteOrderMark({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
}

// Folders or files of `folder`, sorted by name.
std::vector<fs::path> listed(const fs::path& folder, bool folders) {
  std::vector<fs::path> out = sortedEntries(folder);
  std::erase_if(out, [&](const fs::path& path) { return folders ? !isFolder(path) : !isFile(path); });
  return out;
}

bool endsWith(const fs::path& path, std::initializer_list<const char*> endings) {
  const std::string name = lowerCase(path.filename().string());
  return std::any_of(endings.begin(), endings.end(), [&](const char* e) { return name.ends_with(e); });
}

// Empty: no calibration of the kind. `note` receives the reason why a candidate is none.
using Found = Result<std::optional<ImportedCalibration>>;
const std::optional<ImportedCalibration> kNone;

Found readOne(const fs::path& file, Result<ImportedCalibration> (*parse)(const std::string&, const std::string&)) {
  FOURDVT_ASSIGN(const std::string text, readSmall(file));
  FOURDVT_ASSIGN(auto out, parse(text, file.string()));
  return std::optional(std::move(out));
}

// The file itself, or those in the folder, with one of these extensions.
std::vector<fs::path> filesWith(const fs::path& source, std::initializer_list<const char*> endings) {
  std::vector<fs::path> out;
  if (isFile(source)) {
    if (endsWith(source, endings)) out.push_back(source);
    return out;
  }
  for (const fs::path& file : listed(source, false))
    if (endsWith(file, endings)) out.push_back(file);
  return out;
}

Found findColmap(const fs::path& source, std::string&) {
  const bool file = isFile(source);
  if (file && !endsWith(source, {"cameras.txt", "images.txt", "cameras.bin", "images.bin"})) return kNone;
  const fs::path base = file ? source.parent_path() : source;
  for (const char* inner : {"", "cameras", "sparse/0", "sparse", "colmap/sparse/0", "dense/sparse"}) {
    const fs::path folder = *inner ? base / inner : base;
    for (const char* ending : {".txt", ".bin"}) {
      if (!isFile(folder / (std::string("cameras") + ending))) continue;
      for (const char* part : {"cameras", "images", "rigs", "frames"})
        FOURDVT_TRY(checkBytes(folder / (std::string(part) + ending)));
      FOURDVT_ASSIGN(const auto cameras, readColmapListed(folder.string()));
      ImportedCalibration out{"COLMAP", folder.string(), {}, {}, {}, {}, {}};
      addListed(cameras, out);
      return std::optional(std::move(out));
    }
  }
  return kNone;
}

Found findNerfstudio(const fs::path& source, std::string&) {
  for (const fs::path& file : filesWith(source, {"transforms.json"})) return readOne(file, parseNerfstudio);
  for (const fs::path& file : filesWith(source, {"transforms_train.json"})) {
    FOURDVT_ASSIGN(auto found, readOne(file, parseNerfstudio));
    for (const char* other : {"transforms_test.json", "transforms_val.json"})
      if (found && isFile(file.parent_path() / other))
        found->warnings.push_back((file.parent_path() / other).string() +
                                  ": its cameras are left out; import the file itself to have them");
    return found;
  }
  if (!isFile(source) || !endsWith(source, {".json"})) return kNone;
  FOURDVT_ASSIGN(const std::string text, readSmall(source));
  if (text.find("\"transform_matrix\"") == std::string::npos) return kNone;
  return readOne(source, parseNerfstudio);
}

Found findEasyMocap(const fs::path& source, std::string&) {
  for (const fs::path& file : filesWith(source, {"intri.yml", "extri.yml"})) {
    const fs::path folder = file.parent_path();
    FOURDVT_ASSIGN(const std::string intri, readSmall(folder / "intri.yml"));
    FOURDVT_ASSIGN(const std::string extri, readSmall(folder / "extri.yml"));
    FOURDVT_ASSIGN(auto out, parseEasyMocap(intri, extri, folder.empty() ? "." : folder.string()));
    return std::optional(std::move(out));
  }
  return kNone;
}

// Finds Middlebury's NAME_par.txt.
Found findMiddlebury(const fs::path& source, std::string&) {
  for (const fs::path& file : filesWith(source, {"_par.txt"})) return readOne(file, parseMiddlebury);
  return kNone;
}

Found findMetashape(const fs::path& source, std::string&) {
  for (const fs::path& file : filesWith(source, {".xml"})) {
    FOURDVT_ASSIGN(const std::string text, readSmall(file));
    if (looksLikeMetashape(text)) return readOne(file, parseMetashape);
  }
  return kNone;
}

Found findRealityCapture(const fs::path& source, std::string&) {
  for (const fs::path& file : filesWith(source, {".csv"})) {
    FOURDVT_ASSIGN(const std::string text, readSmall(file));
    if (text.starts_with("#") && text.find("#name") < text.find("heading"))
      return readOne(file, parseRealityCaptureCsv);
  }
  ImportedCalibration out{"RealityCapture", source.string(), {}, {}, WorldAxis::Z, {}, {}};
  for (const char* inner : {"", "images"}) {
    if (isFile(source) && *inner) continue;
    for (const fs::path& file : filesWith(*inner ? source / inner : source, {".xmp"})) {
      FOURDVT_ASSIGN(const std::string text, readSmall(file));
      if (!looksLikeRealityCaptureXmp(text)) continue;
      FOURDVT_ASSIGN(out.cameras.emplace_back(), parseRealityCaptureXmp(text, file.stem().string(), file.string()));
    }
    if (!out.cameras.empty()) return std::optional(std::move(out));
  }
  return kNone;
}

Found findActorsHq(const fs::path& source, std::string&) {
  for (const fs::path& file : filesWith(source, {".csv"})) {
    FOURDVT_ASSIGN(const std::string text, readSmall(file));
    std::string_view rest = text, header;
    takeLine(rest, header);
    if (header.find("rx") != header.npos && header.find("px") != header.npos) return readOne(file, parseActorsHq);
  }
  return kNone;
}

Found findQualisys(const fs::path& source, std::string&) {
  for (const fs::path& file : filesWith(source, {".qca.txt"})) return readOne(file, parseQualisys);
  return kNone;
}

// Finds a .toml calibration among a project's other .toml files, perhaps in a folder of its own.
Found findToml(const fs::path& source, std::string& note) {
  for (const char* inner : {"", "calibration", "calib"}) {
    if (isFile(source) && *inner) continue;
    for (const fs::path& file : filesWith(*inner ? source / inner : source, {".toml"})) {
      auto found = readOne(file, parseToml);
      if (found.ok() || found.error().id != ErrorId::FileUnreadable) return found;
      note = found.error().message;
    }
  }
  return kNone;
}

using NamedFiles = std::vector<std::pair<std::string, fs::path>>;

// One file per camera: FOLDER/CAMERA/config.xml, or else FOLDER/CAMERA.xml, or else FOLDER/calibration/CAMERA.xml; or
// the file itself.
std::vector<NamedFiles> filesByCamera(const fs::path& source, std::initializer_list<const char*> endings) {
  const auto namedIn = [&](const fs::path& folder) {
    NamedFiles out;
    for (const fs::path& file : filesWith(folder, endings)) out.emplace_back(file.stem().string(), file);
    return out;
  };
  if (isFile(source)) return {namedIn(source)};
  const std::vector<fs::path> folders = listed(source, true);
  std::vector<NamedFiles> out(1);
  for (const fs::path& folder : folders)
    if (const auto files = filesWith(folder, endings); files.size() == 1)
      out[0].emplace_back(folder.filename().string(), files[0]);
  if (out[0].size() < 2) out.clear();
  out.push_back(namedIn(source));
  for (const fs::path& folder : folders) out.push_back(namedIn(folder));
  return out;
}

// Reads OpenCV cameras; either all files must be cameras, or none.
Found openCvCameras(const fs::path& source, const NamedFiles& files, std::string& note) {
  ImportedCalibration out{"OpenCV FileStorage", source.string(), {}, {}, {}, {}, {}};
  std::optional<Error> failed;
  for (const auto& [name, file] : files) {
    FOURDVT_ASSIGN(const std::string text, readSmall(file));
    auto camera = parseOpenCvCamera(text, name, file.string());
    if (camera.ok())
      out.cameras.push_back(camera.take());
    else if (!failed)
      failed = camera.error();
  }
  if (failed && !out.cameras.empty()) return *failed;
  if (failed && failed->id != ErrorId::FileUnreadable && isFile(source)) return *failed;
  if (failed && note.empty()) note = failed->message;
  if (out.cameras.empty()) return kNone;
  return std::optional(std::move(out));
}

Found findOpenCv(const fs::path& source, std::string& note) {
  for (const NamedFiles& files : filesByCamera(source, {".xml", ".yml", ".yaml", ".json"})) {
    FOURDVT_ASSIGN(auto found, openCvCameras(source, files, note));
    if (found) return found;
  }
  return kNone;
}

Found findProjections(const fs::path& source, std::string&) {
  ImportedCalibration out{"projection matrices", source.string(), {}, {}, {}, {}, {}};
  for (const NamedFiles& files : filesByCamera(source, {".txt"})) {
    for (const auto& [name, file] : files) {
      FOURDVT_ASSIGN(const std::string text, readSmall(file));
      if (!looksLikeProjection(text)) continue;
      FOURDVT_ASSIGN(out.cameras.emplace_back(), parseProjection(text, name, file.string()));
    }
    if (!out.cameras.empty()) return std::optional(std::move(out));
  }
  return kNone;
}

struct CalibrationKind {
  const char* name;
  Found (*find)(const fs::path& source, std::string& note);
};

// In search order.
constexpr CalibrationKind kCalibrationKinds[] = {
    {"COLMAP (cameras.txt, cameras.bin)", findColmap},
    {"nerfstudio and Blender (transforms.json, transforms_train.json)", findNerfstudio},
    {"EasyMocap (intri.yml and extri.yml)", findEasyMocap},
    {"ActorsHQ (calibration.csv)", findActorsHq},
    {"Qualisys (NAME.qca.txt)", findQualisys},
    {"Middlebury (NAME_par.txt)", findMiddlebury},
    {"Metashape (NAME.xml)", findMetashape},
    {"RealityCapture (NAME.csv, CAMERA.xmp)", findRealityCapture},
    {"Pose2Sim and Caliscope (NAME.toml)", findToml},
    {"OpenCV FileStorage (CAMERA.xml, .yml or .json, or CAMERA/ with one)", findOpenCv},
    {"projection matrices (CAMERA.txt)", findProjections},
};

// Makes blanks in camera names plain; file names keep theirs.
Status checkNames(ImportedCalibration& calibration) {
  std::set<std::string> names;
  for (ImportedCamera& imported : calibration.cameras) {
    std::string& name = imported.camera.pinhole.name;
    if (const std::string plain = plainName(name); plain != name) {
      if (imported.file_names.empty()) imported.file_names.push_back(name);
      name = plain;
    }
    const bool plain =
        !name.empty() && name[0] != '.' && name.find_first_of("/\\ \t\r\n") == std::string::npos && isUtf8(name);
    if (!plain) {
      return Error{ErrorId::CameraPose,
                   calibration.path + ": \"" + name + "\" cannot name a camera's files; use letters and digits"};
    }
    if (names.insert(name).second) continue;
    return Error{ErrorId::CameraPose, calibration.path + ": camera \"" + name + "\" is listed twice; rename one"};
  }
  return {};
}

}  // namespace

std::string knownCalibrations() { return joined(kCalibrationKinds, ", ", &CalibrationKind::name); }

Result<ImportedCalibration> readCalibration(const std::string& source) {
  std::error_code ignored;
  if (!fs::exists(source, ignored))
    return Error{ErrorId::FileMissing, source + ": no such file or folder; check the path"};
  std::string note;
  for (const CalibrationKind& kind : kCalibrationKinds) {
    FOURDVT_ASSIGN(auto found, kind.find(source, note));
    if (!found) continue;
    FOURDVT_TRY(checkNames(*found));
    return std::move(*found);
  }
  return Error{ErrorId::FileUnreadable, source + ": no calibration of a known kind" +
                                            (note.empty() ? "" : " (" + note + ")") + "; known are " +
                                            knownCalibrations()};
}

}  // namespace fourdvt::capture
