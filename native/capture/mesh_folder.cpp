// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "capture/mesh_file.h"
#include "capture/mesh_sequence.h"
#include "capture/pictures.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr size_t kMaxDigits = 9;  // longer numbers are no frame numbers

std::set<std::string> fileNames(const std::string& folder) {
  std::set<std::string> names;
  for (const std::filesystem::path& path : sortedEntries(folder))
    if (isFile(path)) names.insert(path.filename().string());
  return names;
}

// Files that differ in one number only.
struct Numbered {
  size_t files = 0, digits = kMaxDigits;  // digits: the minimum; longer numbers are unpadded
  uint32_t smallest = 0xffffffff, largest = 0;
};

// [part before the number, part behind it]
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

// Number of frame 0's file: 0 if all numbers are valid frame numbers (a missing first file is then a missing frame 0),
// else the first number.
uint32_t firstNumber(const Numbered& files, uint32_t frame_count) {
  return files.files == 0 || files.largest < frame_count ? 0 : files.smallest;
}

std::string patternOf(const NumberedFiles::value_type& series) {
  const auto& [around, files] = series;
  return around.first + (files.digits == 1 ? "%" : "%0" + std::to_string(files.digits)) + "d" + around.second;
}

Error noMeshes(const std::string& folder, const std::set<std::string>& names) {
  for (const std::string& name : names) {
    if (const std::string kind = otherMeshKind(name); !kind.empty())
      return {ErrorId::Unsupported, folder + "/" + name + ": " + kind + " is not read; " + kExportReadable};
  }
  return {ErrorId::FileMissing, folder +
                                    ": no meshes in it (.obj, .ply, .glb or .gltf); add them, or write \"mesh\": " +
                                    "null into the sequence in capture.json"};
}

// Series that could each be the sequence's meshes: those with enough files (never a single file), else those with the
// maximum count.
std::vector<const NumberedFiles::value_type*> candidates(const NumberedFiles& numbered, size_t frames) {
  size_t most = 0;
  for (const auto& series : numbered) most = std::max(most, series.second.files);
  std::vector<const NumberedFiles::value_type*> out;
  for (const auto& series : numbered)
    if (series.second.files >= std::min(most, std::max<size_t>(2, frames))) out.push_back(&series);
  return out;
}

Error notOneSeries(const std::string& folder, const std::set<std::string>& meshes,
                   const std::vector<const NumberedFiles::value_type*>& series, const CaptureSequence& sequence) {
  if (meshes.size() == 1) {
    return {ErrorId::InvalidArgument, folder + "/" + *meshes.begin() + ": is one mesh, but \"" + sequence.name +
                                          "\" has " + std::to_string(sequence.frame_count) + " frames; " +
                                          kExportReadable};
  }
  std::string names;
  const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
  if (series.empty())
    for (const std::string& name : meshes) add(name);
  for (const auto* one : series) add(patternOf(*one));
  if (names.size() > 300) names = names.substr(0, 297) + "...";
  const std::string example = series.empty() ? *meshes.begin() : patternOf(*series.front());
  return {ErrorId::InvalidArgument, folder + ": holds several meshes a frame (" + names +
                                        "); name the right ones in capture.json, as \"mesh\": \"" + sequence.name +
                                        "/mesh/" + example + "\" in \"" + sequence.name + "\""};
}

}  // namespace

bool holdsMeshes(const std::string& folder) {
  const std::set<std::string> names = fileNames(folder);
  return std::any_of(names.begin(), names.end(), isMeshName);
}

Status findMeshFiles(const std::string& folder, CaptureSequence& sequence) {
  const std::set<std::string> names = fileNames(folder);
  std::set<std::string> meshes = names;
  std::erase_if(meshes, [](const std::string& name) { return !isMeshName(name); });
  if (meshes.empty()) return noMeshes(folder, names);
  if (meshes.size() == 1 && (sequence.frame_count == 1 || isGltfName(*meshes.begin()))) {
    sequence.mesh_pattern = folder + "/" + *meshes.begin();
    if (sequence.mesh_pattern.find('%') == std::string::npos) return {};
  }
  NumberedFiles numbered;
  for (const std::string& name : meshes) addName(name, numbered);
  const auto series = candidates(numbered, sequence.frame_count);
  if (series.size() != 1 && (series.empty() || meshes.size() > 1))
    return notOneSeries(folder, meshes, series, sequence);
  sequence.mesh_pattern = folder + "/" + patternOf(*series.back());
  sequence.first_mesh = firstNumber(series.back()->second, sequence.first_frame + sequence.frame_count);
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
