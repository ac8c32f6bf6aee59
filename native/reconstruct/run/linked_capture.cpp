// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/linked_capture.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "platform/files.h"
#include "platform/folders.h"

namespace fourdvt::reconstruct {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Status linkOne(const fs::path& from, const fs::path& to) {
  std::error_code failed, no_source, no_target;
  if (fs::exists(fs::symlink_status(to, failed))) return {};
  const fs::path source = fs::canonical(from, no_source), target = fs::canonical(to.parent_path(), no_target);
  if (no_source) return {};  // a link into nowhere is nobody's picture
  if (const fs::path relative = source.lexically_relative(target); !no_target && !relative.empty()) {
    fs::create_symlink(relative, to, failed);
    if (!failed) return {};
  }
  failed.clear();
  fs::copy(from, to, fs::copy_options::recursive, failed);
  if (!failed) return {};
  return Error{ErrorId::WriteFailed, to.string() + ": cannot be linked or copied from " + from.string() + ": " +
                                         failed.message() + "; check space and permissions"};
}

// The report of an earlier reconstruction: written through a link, it would change that one's.
bool isReport(const std::string& name) { return name.starts_with("reconstruct.") || name.starts_with("reconstruct-"); }

// Whether the entry of a sequence's folder belongs to its meshes, as capture.json names them or at their usual place.
bool isMesh(const fs::path& entry, const fs::path& folder, const Json& sequence) {
  if (entry.filename() == kMeshFolder) return true;
  const auto named = [&](const Json& node, const char* key) {
    if (!node.is_object() || !node.contains(key) || !node[key].is_string()) return false;
    const fs::path path = folder / node[key].get<std::string>();
    return path.lexically_normal() == entry.lexically_normal();
  };
  if (!sequence.contains("mesh")) return false;
  const Json& mesh = sequence["mesh"];
  return named(mesh, "topology") || named(mesh, "positions");
}

Result<std::vector<fs::path>> entriesOf(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed))
    out.push_back(it->path());
  if (!failed) return out;
  return Error{ErrorId::FileMissing, folder.string() + ": cannot be listed: " + failed.message() +
                                         "; check that it is there and may be read"};
}

Status linkSequence(const fs::path& from, const fs::path& to, const Json& sequence) {
  const std::string name = sequence.value("name", "");
  FOURDVT_TRY(platform::makeFolder((to / name / kMeshFolder).string()));
  FOURDVT_ASSIGN(const auto entries, entriesOf(from / name));
  for (const fs::path& entry : entries)
    if (!isMesh(entry, from, sequence)) FOURDVT_TRY(linkOne(entry, to / name / entry.filename()));
  return {};
}

}  // namespace

Status linkCapture(const std::string& from, const std::string& to, const std::vector<std::string>& sequences) {
  std::ifstream file(from + "/capture.json");
  Json json = Json::parse(file, nullptr, false);
  if (!json.is_object() || !json.contains("sequences") || !json["sequences"].is_array())
    return Error{ErrorId::CaptureJson, from + "/capture.json: not valid JSON; see the sample capture's capture.json"};
  const auto nameOf = [](const Json& s) { return s.is_object() ? s.value("name", "") : std::string(); };
  std::vector<std::string> all;
  for (const Json& s : json["sequences"]) all.push_back(nameOf(s));

  const Json& listed = json["sequences"];
  FOURDVT_ASSIGN(const auto entries, entriesOf(from));
  for (const fs::path& entry : entries) {
    const std::string name = entry.filename().string();
    const bool of_meshes = std::any_of(listed.begin(), listed.end(),
                                       [&](const Json& s) { return s.is_object() && isMesh(entry, from, s); });
    if (name == "capture.json" || of_meshes || isReport(name) || std::find(all.begin(), all.end(), name) != all.end())
      continue;
    FOURDVT_TRY(linkOne(entry, fs::path(to) / name));
  }
  Json kept = Json::array();
  for (Json sequence : json["sequences"]) {
    const std::string name = nameOf(sequence);
    if (std::find(sequences.begin(), sequences.end(), name) == sequences.end()) continue;
    FOURDVT_TRY(linkSequence(from, to, sequence));
    sequence["mesh"] = name + "/" + kMeshFolder + "/%06d.ply";
    kept.push_back(std::move(sequence));
  }
  json["sequences"] = std::move(kept);
  json["topology"] = "per-frame";
  json.erase("classes");
  return platform::writeFileAtomic(to + "/capture.json", json.dump(2) + "\n");
}

}  // namespace fourdvt::reconstruct
