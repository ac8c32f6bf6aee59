// SPDX-License-Identifier: Apache-2.0
// Bounded little-endian reading and writing. A reader never reads past its span: after the first failure ok() is
// false and every further read returns 0.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace fourdvt {

class ByteReader {
 public:
  explicit ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  bool ok() const { return ok_; }
  size_t position() const { return position_; }
  size_t remaining() const { return bytes_.size() - position_; }
  uint8_t u8() { return read<uint8_t>(); }
  uint16_t u16() { return read<uint16_t>(); }
  uint32_t u32() { return read<uint32_t>(); }
  uint64_t u64() { return read<uint64_t>(); }
  float f32() { return read<float>(); }
  double f64() { return read<double>(); }
  std::span<const uint8_t> bytes(size_t count) {
    if (!ok_ || count > remaining()) {
      ok_ = false;
      return {};
    }
    auto part = bytes_.subspan(position_, count);
    position_ += count;
    return part;
  }

 private:
  template <class T>
  T read() {  // all supported targets are little-endian
    T value{};
    auto part = bytes(sizeof(T));
    if (ok_) std::memcpy(&value, part.data(), sizeof(T));
    return value;
  }
  std::span<const uint8_t> bytes_;
  size_t position_ = 0;
  bool ok_ = true;
};

class ByteWriter {
 public:
  void u8(uint8_t v) { write(v); }
  void u16(uint16_t v) { write(v); }
  void u32(uint32_t v) { write(v); }
  void u64(uint64_t v) { write(v); }
  void f32(float v) { write(v); }
  void f64(double v) { write(v); }
  void bytes(std::span<const uint8_t> part) { out_.insert(out_.end(), part.begin(), part.end()); }
  const std::vector<uint8_t>& data() const { return out_; }
  std::vector<uint8_t> take() { return std::move(out_); }
  size_t size() const { return out_.size(); }

 private:
  template <class T>
  void write(T value) {
    const auto* p = reinterpret_cast<const uint8_t*>(&value);
    out_.insert(out_.end(), p, p + sizeof(T));
  }
  std::vector<uint8_t> out_;
};

}  // namespace fourdvt
