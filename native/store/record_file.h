// SPDX-License-Identifier: Apache-2.0
// File of equally sized, appended records: "PATH.part" until complete, then PATH. An interrupted writer resumes after
// the last complete record. Concurrent writers of one file have distinct names, which are appended to "PATH.part"; the
// first to complete it counts. The content of records is not checked.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::store {

class RecordFile {
 public:
  static bool isComplete(const std::string& path, size_t record_bytes, uint32_t records);
  // Opens an existing file, complete or not, for appending and reading. Errors: WriteFailed.
  static Result<RecordFile> resume(const std::string& path, size_t record_bytes, uint32_t records,
                                   const std::string& writer = {});
  // Starts a new file: finish() replaces a complete one, which remains readable until then.
  static Result<RecordFile> begin(const std::string& path, size_t record_bytes, uint32_t records,
                                  const std::string& writer = {});
  static Result<std::vector<uint8_t>> readOne(const std::string& path, size_t record_bytes, uint32_t index);

  uint32_t count() const { return count_; }
  Status append(std::span<const uint8_t> record);
  Result<std::vector<uint8_t>> read(uint32_t index);
  // Renames the file into place if it holds all records.
  Status finish();

 private:
  RecordFile(const std::string& path, size_t record_bytes, uint32_t records)
      : path_(path), record_bytes_(record_bytes), records_(records) {}
  struct Closer {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::string path_, open_path_;
  size_t record_bytes_ = 0;
  uint32_t records_ = 0, count_ = 0;
  std::unique_ptr<std::FILE, Closer> file_;
};

}  // namespace fourdvt::store
