// SPDX-License-Identifier: Apache-2.0
// PNG metadata that tests write: EXIF and colour profiles.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>

namespace fourdvt::capture {

inline std::string bigEndian(uint32_t value, int bytes) {
  std::string out;
  for (int i = bytes - 1; i >= 0; --i) out += char(value >> (8 * i) & 0xff);
  return out;
}

// TIFF header with the orientation as the only tag of its first directory.
inline std::string exif(int orientation, bool big_endian) {
  if (big_endian)
    return std::string("MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0", 19) + char(orientation) +
           std::string("\0\0\0\0\0\0", 6);
  return std::string("II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0", 18) + char(orientation) +
         std::string("\0\0\0\0\0\0\0", 7);
}

inline std::string pngChunk(const std::string& kind, const std::string& data) {
  const std::string body = kind + data;
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), uInt(body.size()));
  return bigEndian(uint32_t(data.size()), 4) + body + bigEndian(uint32_t(crc), 4);
}

constexpr size_t kPngHeader = 33;  // signature and IHDR

// Inserts a chunk before the pixels of a PNG.
inline void addChunk(const std::string& path, const std::string& kind, const std::string& data) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  std::ofstream(path, std::ios::binary) << bytes.insert(kPngHeader, pngChunk(kind, data));
}

}  // namespace fourdvt::capture
