// SPDX-License-Identifier: Apache-2.0
// Folders and files of finished work, from which an interrupted command resumes. A folder holds its key, the text of
// the settings that its files depend on; a file holds a hash of its bytes, so that a damaged or truncated one counts as
// absent. Files are written atomically.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "store/archive.h"

namespace fourdvt::store {

using Bytes = std::vector<uint8_t>;

// Key of a folder; none: the folder was not made by setKey, or removeFolder has removed it in part.
std::optional<std::string> keyOf(const std::string& folder);
// Creates the folder and its parents, and writes the key. Errors: WriteFailed.
Status setKey(const std::string& folder, const std::string& key);
// Removes the folder, the key last.
void removeFolder(const std::string& folder);

// FOLDER/WHAT_<hash of key>.bin
std::string keyedPath(const std::string& folder, const std::string& what, const std::string& key);

enum class Written { ToDisk, ToCache };  // ToCache: neither atomic nor synchronous, for results that can be recomputed
// Errors: WriteFailed.
Status saveBytes(const std::string& path, Bytes bytes, Written written = Written::ToDisk);
// Errors: FileMissing, FileUnreadable; Internal if damaged.
Result<Bytes> loadBytes(const std::string& path);
Error damagedFile(const std::string& path);

template <class T>
Status save(const std::string& path, const T& value, Written written = Written::ToDisk) {
  return saveBytes(path, bytesOf(value), written);
}

// Errors: those of loadBytes.
template <class T>
Result<T> load(const std::string& path) {
  FOURDVT_ASSIGN(const Bytes bytes, loadBytes(path));
  T value;
  if (!readBytes(bytes, value)) return damagedFile(path);
  return value;
}

}  // namespace fourdvt::store
