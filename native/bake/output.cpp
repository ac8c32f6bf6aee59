// SPDX-License-Identifier: Apache-2.0
#include "bake/output.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

namespace fourdvt::bake {
namespace {

namespace fs = std::filesystem;

Error writeError(const std::string& path, const std::string& why) {
  return {ErrorId::WriteFailed, path + ": cannot write: " + why + "; free disk space or choose another output folder"};
}

struct FileCloser {
  void operator()(std::FILE* f) const { std::fclose(f); }
};

}  // namespace

Status writeFile(const std::string& path, std::span<const uint8_t> bytes) {
  const std::string temporary = path + ".part";
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  if (!file) return writeError(path, std::strerror(errno));
  bool ok = bytes.empty() || std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  ok = ok && std::fflush(file) == 0 && fsync(fileno(file)) == 0;
  int code = ok ? 0 : errno;
  if (std::fclose(file) != 0 && ok) code = errno, ok = false;
  if (ok && std::rename(temporary.c_str(), path.c_str()) != 0) code = errno, ok = false;
  if (ok) return {};
  std::remove(temporary.c_str());
  return writeError(path, std::strerror(code));
}

Status writeFile(const std::string& path, const std::string& text) {
  return writeFile(path, std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

Result<std::vector<uint8_t>> readFile(const std::string& path) {
  std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "rb"));
  if (!file) return Error{ErrorId::FileMissing, path + ": cannot be opened: " + std::strerror(errno)};
  std::vector<uint8_t> bytes(fileBytes(path));
  if (std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size())
    return Error{ErrorId::FileUnreadable, path + ": cannot be read"};
  return bytes;
}

uint64_t fileBytes(const std::string& path) {
  std::error_code error;
  const auto bytes = fs::file_size(path, error);
  return error ? 0 : bytes;
}

Status makeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) return writeError(path, error.message());
  return {};
}

void removeFolder(const std::string& path) {
  std::error_code error;
  fs::remove_all(path, error);
}

void removeIfEmpty(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) fs::remove(path, error);
}

Status replaceFolder(const std::string& from, const std::string& to, const std::string& previous) {
  std::error_code error;
  removeFolder(previous);
  const bool exists = fs::exists(to, error);
  if (exists) fs::rename(to, previous, error);
  if (error) return writeError(to, error.message());
  fs::rename(from, to, error);
  if (!error) return {};
  std::error_code ignored;
  if (exists) fs::rename(previous, to, ignored);
  return writeError(to, error.message());
}

}  // namespace fourdvt::bake
