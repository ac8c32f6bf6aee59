// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/writer.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "platform/files.h"

namespace fourdvt::studio {
namespace {

namespace fs = std::filesystem;
constexpr const char* kMarker = "/studio.unfinished";

bool isStudioCapture(const std::string& folder) {
  const auto bytes = platform::readFile(folder + "/capture.json");
  if (!bytes) return false;
  const auto root = nlohmann::json::parse(bytes.value(), nullptr, false);
  return root.is_object() && root.contains("studio");
}

Error notWritable(const std::string& path, const std::error_code& why) {
  return {ErrorId::WriteFailed, path + ": " + why.message() + "; choose a folder that can be written"};
}

}  // namespace

Result<OutputFolder> OutputFolder::open(const std::string& given) {
  std::string folder = given;
  while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
  const std::string work = folder + ".work";
  std::error_code failed;
  if (fs::exists(folder, failed) && !isStudioCapture(folder))
    return Error{ErrorId::InvalidArgument, folder + ": exists and is not a studio capture; choose another folder"};
  if (fs::exists(work, failed)) {
    if (!fs::exists(work + kMarker, failed))
      return Error{ErrorId::InvalidArgument, work + ": is in the way and was not made here; move it or choose another"};
    fs::remove_all(work, failed);
  }
  FOURDVT_TRY(platform::makeFolder(work));
  OutputFolder out(folder, work);
  FOURDVT_TRY(platform::writeFileAtomic(work + kMarker, "A studio capture that is not finished. May be deleted.\n"));
  return out;
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : folder_(std::move(other.folder_)), work_(std::move(other.work_)) {
  other.work_.clear();
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!work_.empty()) fs::remove_all(work_, ignored);
}

Status OutputFolder::makeFolder(const std::string& name) const { return platform::makeFolder(work_ + "/" + name); }

Status OutputFolder::keep() {
  std::error_code failed;
  fs::remove(work_ + kMarker, failed);
  if (fs::exists(folder_, failed)) fs::remove_all(folder_, failed);
  if (!failed) fs::rename(work_, folder_, failed);
  if (failed) return notWritable(folder_, failed);
  work_.clear();
  return {};
}

Status Ticker::tick() {
  ++progress_.done;
  if (environment_.progress) environment_.progress(progress_);
  if (environment_.stop && environment_.stop->load())
    return Error{ErrorId::Interrupted, "stopped; nothing was kept, run the same command again"};
  return {};
}

}  // namespace fourdvt::studio
