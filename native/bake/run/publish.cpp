// SPDX-License-Identifier: Apache-2.0
#include "bake/run/publish.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

#include "bake/run/describe.h"
#include "package/character.h"
#include "platform/files.h"
#include "platform/folders.h"

namespace fourdvt::bake {
namespace {

constexpr int kPlacedAtOnce = 5;  // tries more, where processes finish the same job at once

namespace fs = std::filesystem;

// No bake has made a file of another name; a manifest may come from elsewhere.
bool isFileName(const std::string& name) {
  constexpr const char* kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  return !name.empty() && name[0] != '.' && name.find_first_not_of(kAllowed) == std::string::npos;
}

// Collects the names of files that a manifest gives, directly or by the names of sequences and cameras.
class Names {
 public:
  explicit Names(const FlatJson& gltf) : gltf_(gltf) {}
  void addUri(const std::string& at) { add("", at + "/uri", ""); }
  void add(const std::string& before, const std::string& pointer, const std::string& after) {
    const auto name = gltf_.string(pointer);
    if (name && isFileName(before + *name + after)) files.insert(before + *name + after);
  }
  std::set<std::string> files;

 private:
  const FlatJson& gltf_;
};

void addSequence(const FlatJson& gltf, const std::string& at, Names& names) {
  names.addUri(at + "/stream");
  names.add("report_", at + "/name", ".jpg");
  for (int r = 0; gltf.has(at + "/renditions/" + std::to_string(r)); ++r)
    names.addUri(at + "/renditions/" + std::to_string(r));
  for (int e = 0; gltf.has(at + "/sound/encodings/" + std::to_string(e)); ++e)
    names.addUri(at + "/sound/encodings/" + std::to_string(e));
}

// Files of the bake that made the folder; none if its manifest is not a bake's.
std::set<std::string> bakedFiles(const std::string& folder) {
  const auto read = platform::readJsonFlat(folder + "/" + kManifestFile);
  const std::string at = std::string("/extensions/") + package::kExtensionName;
  if (!read || !read.value().has(at)) return {};
  const FlatJson& gltf = read.value();
  Names names(gltf);
  for (const char* part : {"/mesh", "/poster", "/graph", "/room", "/start"}) names.addUri(at + part);
  names.addUri("/images/0");
  for (int s = 0; gltf.has(at + "/sequences/" + std::to_string(s)); ++s)
    addSequence(gltf, at + "/sequences/" + std::to_string(s), names);
  for (int c = 0; gltf.has(at + "/cameras/" + std::to_string(c)); ++c)
    names.add("report_outline_", at + "/cameras/" + std::to_string(c) + "/name", ".jpg");
  for (const std::string file : {"report.html", "report.json", "report_tiles.jpg"}) names.files.insert(file);
  for (const std::string file : {"/cameras.txt", "/images.txt"}) names.files.insert(kRefinedCameras + file);
  return names.files;
}

// Files in `from` in the order in which they are moved: new names, then those that replace a file, then the manifest.
std::vector<std::string> inOrder(const std::string& from, const std::string& to) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(from, error), end; entry != end; entry.increment(error))
    if (!entry->is_directory(error)) files.push_back(fs::relative(entry->path(), from, error).string());
  const auto rank = [&](const std::string& file) {
    return file == kManifestFile ? 2 : fs::exists(to + "/" + file, error) ? 1 : 0;
  };
  std::sort(files.begin(), files.end());
  std::stable_sort(files.begin(), files.end(),
                   [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
  return files;
}

// Readers see the old file or the new one. The folder may be a link to another file system.
Status move(const std::string& from, const std::string& to) {
  std::error_code error;
  FOURDVT_TRY(platform::makeFolder(fs::path(to).parent_path().string()));
  fs::rename(from, to, error);
  if (error == std::errc::cross_device_link) {
    FOURDVT_ASSIGN(const auto bytes, platform::readFile(from));
    return platform::writeFileAtomic(to, bytes);
  }
  if (!error) return {};
  return Error{ErrorId::WriteFailed, to + ": cannot write: " + error.message() + "; choose another output folder"};
}

void removeFiles(const std::string& folder, const std::set<std::string>& files) {
  std::error_code ignored;
  for (const std::string& file : files)
    if (!fs::is_directory(folder + "/" + file, ignored)) fs::remove(folder + "/" + file, ignored);
  platform::removeIfEmpty(folder + "/" + kRefinedCameras);
}

// Moves the files in order; on failure takes back those that have new names.
Status moveAll(const std::vector<std::string>& files, const std::string& from, const std::string& to) {
  std::set<std::string> added;
  for (const std::string& file : files) {
    std::error_code ignored;
    const bool is_new = !fs::exists(to + "/" + file, ignored);
    if (const Status moved = move(from + "/" + file, to + "/" + file); !moved.ok()) {
      removeFiles(to, added);
      return moved;
    }
    if (is_new) added.insert(file);
  }
  return {};
}

}  // namespace

Status publish(const std::string& from, const std::string& to) {
  std::error_code error;
  if (!fs::exists(to, error)) {
    const Status placed = platform::replaceFolder(from, to, from + ".previous");
    if (placed.ok() || !fs::exists(to, error)) return placed;  // else another process was earlier
  }
  const std::vector<std::string> files = inOrder(from, to);
  std::set<std::string> old = bakedFiles(to);
  FOURDVT_TRY(moveAll(files, from, to));
  for (const std::string& file : files) old.erase(file);
  removeFiles(to, old);
  platform::removeFolder(from);
  return {};
}

Status publishReport(const std::string& from, const std::string& to) {
  const std::string previous = from + ".previous";
  Status placed = platform::replaceFolder(from, to, previous);
  for (int again = 0; again < kPlacedAtOnce && !placed.ok(); ++again)  // another process replaces it, too
    placed = platform::replaceFolder(from, to, previous);
  platform::removeFolder(previous);
  return placed;
}

}  // namespace fourdvt::bake
