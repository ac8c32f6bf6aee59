// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/job_file.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/hash.h"
#include "platform/files.h"

namespace fourdvt::reconstruct {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFile = "/reconstruction.json";
constexpr int kFormat = 1;
constexpr size_t kDigits = 16;

std::string digitsOf(uint64_t value) {
  char text[kDigits + 1];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

// Calls with the name and the field of every option that frames and their report depend on.
template <class Options, class Field>
void eachField(Options& o, const Field& field) {
  field("capture", o.capture_folder);
  field("folder", o.folder);
  field("sequences", o.sequences);
  field("leave_out", o.leave_out);
  field("mattes_alone", o.mattes_alone);
  field("any_silhouettes", o.any_silhouettes);
  field("synchronise", o.synchronise);
  field("refine_cameras", o.refine_cameras);
  field("hull", o.hull);
  field("contour_tolerance_px", o.contour_tolerance_px);
  field("voxel_m", o.voxel_m);
  field("faces", o.faces);
  field("adaptivity", o.adaptivity);
  field("stereo", o.stereo);
  field("planes", o.planes);
  field("fairing", o.fairing);
}

JobFile jobFrom(const Json& json) {
  JobFile out;
  eachField(out.job.options, [&](const char* name, auto& value) { json.at("options").at(name).get_to(value); });
  json.at("settings_key").get_to(out.job.settings_key);
  json.at("warnings").get_to(out.job.warnings);
  json.at("name").get_to(out.job.name);
  out.common_input_digest = std::stoull(json.at("common_input_digest").get<std::string>(), nullptr, 16);
  return out;
}

}  // namespace

// The first line is the hash of the others.
Status writeJobFile(const std::string& job_folder, const JobFile& file) {
  Json json;
  json["format"] = kFormat;
  eachField(file.job.options, [&](const char* name, const auto& value) { json["options"][name] = value; });
  json["settings_key"] = file.job.settings_key;
  json["warnings"] = file.job.warnings;
  json["name"] = file.job.name;
  json["common_input_digest"] = digitsOf(file.common_input_digest);
  const std::string text = json.dump(1) + "\n";
  return platform::writeFileAtomic(job_folder + kFile, digitsOf(fnv1a(text)) + "\n" + text);
}

Result<JobFile> readJobFile(const std::string& job_folder) {
  const std::string path = job_folder + kFile;
  const auto bytes = platform::readFile(path);
  if (!bytes) return Error{ErrorId::FileMissing, path + ": there is none; run `fourdvt plan` again"};
  const Error damaged{ErrorId::FileUnreadable,
                      path + ": damaged, or of another version; delete it and run `fourdvt plan` again"};
  const std::string all(bytes.value().begin(), bytes.value().end());
  if (all.size() < kDigits + 1) return damaged;
  const std::string text = all.substr(kDigits + 1);
  if (all.substr(0, kDigits) != digitsOf(fnv1a(text))) return damaged;
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || json.value("format", 0) != kFormat) return damaged;
  try {
    return jobFrom(json);
  } catch (const std::exception&) {
    return damaged;
  }
}

}  // namespace fourdvt::reconstruct
