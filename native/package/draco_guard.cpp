// SPDX-License-Identifier: Apache-2.0
#include "package/draco_guard.h"

#include "base/bytes.h"
#include "draco/compression/config/compression_shared.h"

namespace fourdvt::package {
namespace {

uint32_t varint(ByteReader& in) {
  uint32_t value = 0;
  for (int shift = 0; shift < 35; shift += 7) {
    const uint8_t byte = in.u8();
    value |= static_cast<uint32_t>(byte & 0x7f) << (shift < 32 ? shift : 31);
    if (!(byte & 0x80)) return value;
  }
  return UINT32_MAX;
}

// "DRACO", version, type, method, flags without metadata.
bool headerIs(ByteReader& in, uint8_t minor, uint8_t type, uint8_t method) {
  const auto magic = in.bytes(5);
  if (!in.ok() || std::memcmp(magic.data(), "DRACO", 5) != 0) return false;
  const bool version_ok = in.u8() == 2 && in.u8() == minor;
  const bool kind_ok = in.u8() == type && in.u8() == method;
  return version_ok && kind_ok && in.u16() == 0 && in.ok();
}

}  // namespace

bool looksLikeMesh(std::span<const uint8_t> bytes, uint32_t max_faces) {
  constexpr uint64_t kMaxFacesPerByte = 64;
  ByteReader in(bytes);
  if (!headerIs(in, draco::kDracoMeshBitstreamVersionMinor, draco::TRIANGULAR_MESH, draco::MESH_EDGEBREAKER_ENCODING)) {
    return false;
  }
  in.u8();  // traversal
  const uint32_t vertices = varint(in), faces = varint(in);
  const uint8_t attribute_tables = in.u8();
  const uint32_t symbols = varint(in), splits = varint(in);
  if (!in.ok() || vertices < 3 || faces < 1 || faces > max_faces) return false;
  return faces <= kMaxFacesPerByte * bytes.size() && vertices <= 3ull * faces && attribute_tables <= 8 &&
         symbols <= faces && splits <= symbols;
}

}  // namespace fourdvt::package
