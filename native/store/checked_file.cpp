// SPDX-License-Identifier: Apache-2.0
#include "store/checked_file.h"

#include "base/bytes.h"
#include "base/hash.h"
#include "platform/files.h"

namespace fourdvt::store {

Status saveChecked(const std::string& path, std::span<const uint8_t> payload) {
  ByteWriter out;
  out.bytes(payload);
  out.u64(fnv1a(payload));
  return platform::writeFileAtomic(path, out.data());
}

Error damagedFile(const std::string& path) {
  return {ErrorId::Internal, path + ": is damaged; delete it and bake again, or run `fourdvt plan` again"};
}

Result<std::vector<uint8_t>> loadChecked(const std::string& path) {
  FOURDVT_ASSIGN(std::vector<uint8_t> bytes, platform::readFile(path));
  if (bytes.size() < 8) return damagedFile(path);
  const std::span<const uint8_t> payload(bytes.data(), bytes.size() - 8);
  ByteReader tail(std::span<const uint8_t>(bytes).subspan(payload.size()));
  if (tail.u64() != fnv1a(payload)) return damagedFile(path);
  bytes.resize(payload.size());
  return bytes;
}

}  // namespace fourdvt::store
