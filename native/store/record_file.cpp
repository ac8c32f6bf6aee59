// SPDX-License-Identifier: Apache-2.0
#include "store/record_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "platform/files.h"

namespace fourdvt::store {
namespace {

namespace fs = std::filesystem;

Error cannotWrite(const std::string& path, int code) {
  return {ErrorId::WriteFailed,
          path + ": cannot write: " + std::strerror(code) + "; free disk space or choose another output folder"};
}

Result<std::vector<uint8_t>> readAt(std::FILE* file, const std::string& path, size_t record_bytes, uint32_t index) {
  std::vector<uint8_t> record(record_bytes);
  if (!file || fseeko(file, static_cast<off_t>(record_bytes) * index, SEEK_SET) != 0 ||
      std::fread(record.data(), 1, record_bytes, file) != record_bytes)
    return Error{ErrorId::FileUnreadable,
                 path + ": record " + std::to_string(index) +
                     " is missing; delete this file and bake again, or run `fourdvt plan` again"};
  return record;
}

}  // namespace

bool RecordFile::isComplete(const std::string& path, size_t record_bytes, uint32_t records) {
  return fs::exists(path) && platform::fileBytes(path) == uint64_t(record_bytes) * records;
}

Result<RecordFile> RecordFile::resume(const std::string& path, size_t record_bytes, uint32_t records,
                                      const std::string& writer) {
  RecordFile out(path, record_bytes, records);
  const bool complete = isComplete(path, record_bytes, records);
  out.open_path_ = complete ? path : path + ".part" + writer;
  std::error_code ignored;
  if (!complete && fs::exists(out.open_path_, ignored)) {  // drops an incomplete last record
    const uint64_t whole = platform::fileBytes(out.open_path_) / record_bytes;
    fs::resize_file(out.open_path_, std::min<uint64_t>(whole, records) * record_bytes, ignored);
  }
  out.file_.reset(std::fopen(out.open_path_.c_str(), complete ? "rb" : "a+b"));
  if (!out.file_) return cannotWrite(out.open_path_, errno);
  out.count_ = static_cast<uint32_t>(platform::fileBytes(out.open_path_) / record_bytes);
  return out;
}

Result<RecordFile> RecordFile::begin(const std::string& path, size_t record_bytes, uint32_t records,
                                     const std::string& writer) {
  RecordFile out(path, record_bytes, records);
  out.open_path_ = path + ".part" + writer;
  out.file_.reset(std::fopen(out.open_path_.c_str(), "w+b"));
  if (!out.file_) return cannotWrite(out.open_path_, errno);
  return out;
}

Result<std::vector<uint8_t>> RecordFile::readOne(const std::string& path, size_t record_bytes, uint32_t index) {
  std::unique_ptr<std::FILE, Closer> file(std::fopen(path.c_str(), "rb"));
  return readAt(file.get(), path, record_bytes, index);
}

Status RecordFile::append(std::span<const uint8_t> record) {
  if (record.size() != record_bytes_ || count_ >= records_)
    return Error{ErrorId::Internal, path_ + ": a record has the wrong size, or there are too many"};
  if (std::fseek(file_.get(), 0, SEEK_END) != 0 ||
      std::fwrite(record.data(), 1, record.size(), file_.get()) != record.size() || std::fflush(file_.get()) != 0)
    return cannotWrite(open_path_, errno);
  ++count_;
  return {};
}

Result<std::vector<uint8_t>> RecordFile::read(uint32_t index) {
  return readAt(file_.get(), open_path_, record_bytes_, index);
}

Status RecordFile::finish() {
  if (open_path_ == path_) return {};
  if (count_ != records_) return Error{ErrorId::Internal, path_ + ": records are missing"};
  // Synchronises to disk before the rename, since a network file system may report a full disk only then.
  if (std::fflush(file_.get()) != 0 || ::fsync(::fileno(file_.get())) != 0 || std::fclose(file_.release()) != 0)
    return cannotWrite(open_path_, errno);
  std::error_code error;
  fs::rename(open_path_, path_, error);
  if (error) return cannotWrite(path_, error.value());
  open_path_ = path_;
  file_.reset(std::fopen(path_.c_str(), "rb"));
  return {};
}

}  // namespace fourdvt::store
