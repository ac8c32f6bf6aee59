// SPDX-License-Identifier: Apache-2.0
#include "store/folder.h"

#include <fstream>

#include "base/hash.h"
#include "base/text.h"
#include "platform/files.h"

namespace fourdvt::store {
namespace {

constexpr const char* kKeyFile = "settings.txt";

}  // namespace

std::optional<std::string> keyOf(const std::string& folder) {
  auto text = platform::readText(folder + "/" + kKeyFile);
  return text ? std::optional(text.take()) : std::nullopt;
}

Status setKey(const std::string& folder, const std::string& key) {
  FOURDVT_TRY(platform::makeFolder(folder));
  return platform::writeFileAtomic(folder + "/" + kKeyFile, key);
}

void removeFolder(const std::string& folder) { platform::removeFolder(folder, kKeyFile); }

std::string keyedPath(const std::string& folder, const std::string& what, const std::string& key) {
  return folder + "/" + what + "_" + hexDigits(fnv1a(key)) + ".bin";
}

Error damagedFile(const std::string& path) {
  return {ErrorId::Internal, path + ": is damaged; delete it and bake again, or run `fourdvt plan` again"};
}

Status saveBytes(const std::string& path, Bytes bytes, Written written) {
  ByteWriter hash;
  hash.u64(fnv1a(bytes));
  bytes.insert(bytes.end(), hash.data().begin(), hash.data().end());
  if (written == Written::ToDisk) return platform::writeFileAtomic(path, bytes);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (file) return {};
  return Error{ErrorId::WriteFailed, path + ": cannot be written; free some space"};
}

Result<Bytes> loadBytes(const std::string& path) {
  FOURDVT_ASSIGN(Bytes bytes, platform::readFile(path));
  if (bytes.size() < sizeof(uint64_t)) return damagedFile(path);
  const size_t size = bytes.size() - sizeof(uint64_t);
  const uint64_t hash = ByteReader(std::span<const uint8_t>(bytes).subspan(size)).u64();
  bytes.resize(size);
  if (fnv1a(bytes) != hash) return damagedFile(path);
  return bytes;
}

}  // namespace fourdvt::store
