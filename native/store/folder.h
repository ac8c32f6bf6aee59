// SPDX-License-Identifier: Apache-2.0
// Folders and files of finished work, from which an interrupted command goes on. A folder has the text of the settings
// that its files depend on, its key; a file has a hash of its bytes, so that one that is damaged or half written counts
// as absent. Files are written atomically.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "store/archive.h"

namespace fourdvt::store {

using Bytes = std::vector<uint8_t>;

// The key of a folder; none: it has not been made by setKey, or removeFolder has removed it in part.
std::optional<std::string> keyOf(const std::string& folder);
// Makes the folder and its parents. Errors: WriteFailed.
Status setKey(const std::string& folder, const std::string& key);
// The key goes last.
void removeFolder(const std::string& folder);

// FOLDER/WHAT_<hash of key>.bin
std::string keyedPath(const std::string& folder, const std::string& what, const std::string& key);

enum class Written { ToDisk, ToCache };  // ToCache: not atomic and without waiting, for what can be made again
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
