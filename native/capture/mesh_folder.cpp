// SPDX-License-Identifier: Apache-2.0
#include "capture/mesh_folder.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>

#include "capture/mesh_sequence.h"
#include "capture/pictures.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr size_t kMaxDigits = 9;  // a longer number is no frame's

bool isDigit(char c) { return c >= '0' && c <= '9'; }

bool isMeshName(const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".obj" || extension == ".ply" || extension == ".glb" || extension == ".gltf";
}

std::set<std::string> fileNames(const std::string& folder) {
  std::set<std::string> names;
  std::error_code failed;
  for (std::filesystem::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    std::error_code ignored;
    if (it->is_regular_file(ignored)) names.insert(it->path().filename().string());
  }
  return names;
}

// Files that differ in one number only.
struct Numbered {
  size_t files = 0, digits = kMaxDigits;  // digits: the least; longer numbers are not padded
  uint32_t smallest = 0xffffffff, largest = 0;
};

// [what stands before the number, what stands behind it]
using NumberedFiles = std::map<std::pair<std::string, std::string>, Numbered>;

void addName(const std::string& name, NumberedFiles& out) {
  const size_t stem_end = name.rfind('.');
  for (size_t begin = 0; begin < stem_end;) {
    size_t end = begin;
    while (end < stem_end && isDigit(name[end])) ++end;
    if (end > begin && end - begin <= kMaxDigits) {
      Numbered& files = out[{name.substr(0, begin), name.substr(end)}];
      const auto number = *toNumber<uint32_t>(std::string_view(name).substr(begin, end - begin));
      ++files.files;
      files.digits = std::min(files.digits, end - begin);
      files.smallest = std::min(files.smallest, number);
      files.largest = std::max(files.largest, number);
    }
    begin = std::max(end, begin + 1);
  }
}

// Numbers that all fit the frames are the frames' own: then a missing first file is a missing frame 0.
uint32_t firstNumber(const Numbered& files, uint32_t frame_count) {
  return files.files == 0 || files.largest < frame_count ? 0 : files.smallest;
}

}  // namespace

bool holdsMeshes(const std::string& folder) {
  const std::set<std::string> names = fileNames(folder);
  return std::any_of(names.begin(), names.end(), isMeshName);
}

Status findMeshFiles(const std::string& folder, CaptureSequence& sequence) {
  NumberedFiles numbered;
  std::set<std::string> meshes = fileNames(folder);
  std::erase_if(meshes, [](const std::string& name) { return !isMeshName(name); });
  for (const std::string& name : meshes) addName(name, numbered);
  if (meshes.empty()) {
    return Error{ErrorId::FileMissing, folder + ": no meshes (.obj, .ply, .glb or .gltf), but capture.json says " +
                                           "\"topology\": \"per-frame\"; add them, or remove that line"};
  }
  if (sequence.frame_count == 1 && meshes.size() == 1) {
    sequence.mesh_pattern = folder + "/" + *meshes.begin();
    if (sequence.mesh_pattern.find('%') == std::string::npos) return {};
  }
  auto best = numbered.end();
  bool several = false;
  for (auto it = numbered.begin(); it != numbered.end(); ++it) {
    const size_t most = best == numbered.end() ? 0 : best->second.files;
    if (it->second.files < most) continue;
    several = it->second.files == most && meshes.size() > 1;
    best = it;
  }
  if (best == numbered.end() || several) {
    return Error{ErrorId::InvalidArgument,
                 folder + ": " + *meshes.begin() + " and others could each be the sequence's meshes; " +
                     "leave one series there, or say which as \"mesh\" in capture.json, " + "with %06d for the number"};
  }
  const auto& [around, files] = *best;
  sequence.mesh_pattern = folder + "/" + around.first + "%0" + std::to_string(files.digits) + "d" + around.second;
  sequence.first_mesh = firstNumber(files, sequence.first_frame + sequence.frame_count);
  return {};
}

void findFirstMesh(CaptureSequence& sequence) {
  sequence.first_mesh = 0;
  const std::filesystem::path pattern = sequence.mesh_pattern;
  const std::string name = pattern.filename().string();
  const size_t percent = name.find('%');
  if (percent == std::string::npos || isFile(meshPath(sequence, 0))) return;
  NumberedFiles numbered;
  for (const std::string& file : fileNames(pattern.parent_path().string())) addName(file, numbered);
  const auto found = numbered.find({name.substr(0, percent), name.substr(name.find('d', percent) + 1)});
  if (found != numbered.end())
    sequence.first_mesh = firstNumber(found->second, sequence.first_frame + sequence.frame_count);
}

Status checkMeshFiles(const CaptureSequence& sequence) {
  std::string first;
  uint32_t missing = 0;
  for (uint32_t frame = 0; frame < sequence.frame_count; ++frame) {
    const std::string path = meshPath(sequence, frame);
    if (isFile(path)) continue;
    if (missing++ == 0) first = path;
  }
  if (missing == 0) return {};
  return Error{ErrorId::FileMissing,
               first + ": no such file; " + std::to_string(missing) + " of the " +
                   std::to_string(sequence.frame_count) + " frames of \"" + sequence.name +
                   "\" have no mesh: export them, or make the sequence shorter (\"frames\" in capture.json)"};
}

}  // namespace fourdvt::capture
