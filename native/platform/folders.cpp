// SPDX-License-Identifier: Apache-2.0
#include "platform/folders.h"

#include <filesystem>
#include <vector>

namespace fourdvt::platform {
namespace {

namespace fs = std::filesystem;

Error writeError(const std::string& path, const std::error_code& why) {
  return {ErrorId::WriteFailed,
          path + ": cannot write: " + why.message() + "; free disk space or choose another output folder"};
}

}  // namespace

Status makeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  return error ? Status(writeError(path, error)) : Status();
}

void removeFolder(const std::string& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

void removeFolder(const std::string& path, const std::string& last) {
  removeEntries(path, [&](const std::string& name) { return name != last; });
  removeFolder(path);
}

void removeEntries(const std::string& folder, const std::function<bool(const std::string& name)>& chosen) {
  std::error_code failed, ignored;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed))
    if (chosen(entry->path().filename().string())) found.push_back(entry->path());
  for (const fs::path& path : found) fs::remove_all(path, ignored);
}

void removeIfEmpty(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) fs::remove(path, error);
}

Status replaceFolder(const std::string& from, const std::string& to, const std::string& previous) {
  std::error_code error;
  if (!fs::exists(from, error)) return writeError(to, std::make_error_code(std::errc::no_such_file_or_directory));
  removeFolder(previous);
  const bool exists = fs::exists(to, error);
  if (exists) fs::rename(to, previous, error);
  if (error) return writeError(to, error);
  fs::rename(from, to, error);
  if (!error) return {};
  std::error_code ignored;
  if (exists) fs::rename(previous, to, ignored);
  return writeError(to, error);
}

}  // namespace fourdvt::platform
