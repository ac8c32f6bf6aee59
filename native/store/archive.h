// SPDX-License-Identifier: Apache-2.0
// Binary serialisation of structs. One list of fields covers both directions: a function of this namespace,
//   void fields(Archive& archive, Struct& s) { archive(s.name, s.count, s.list); }
// declared before the struct is archived, in a header if several files archive it. Strings, vectors, maps, optional and
// shared values are supported; types without a list are copied as they lie in memory. Bytes are readable only by the
// build that wrote them: this is not an interchange format.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "base/bytes.h"
#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::store {

class Archive {
 public:
  Archive() = default;  // writes
  // Reads from a borrowed span. Reading beyond its end is safe: missing bytes make complete() false.
  explicit Archive(std::span<const uint8_t> bytes) : in_(bytes), reads_(true) {}
  bool reads() const { return reads_; }
  template <class... Ts>
  void operator()(Ts&... values) {
    (visit(values), ...);
  }
  // True if exactly these bytes have been read.
  bool complete() const { return in_.ok() && in_.remaining() == 0; }
  std::vector<uint8_t> take() { return out_.take(); }

 private:
  void raw(void* data, size_t bytes) {
    if (!reads_) return out_.bytes({static_cast<const uint8_t*>(data), bytes});
    const auto part = in_.bytes(bytes);
    if (!part.empty()) std::memcpy(data, part.data(), part.size());
  }
  // Number of items of at least `bytes` each; 0 if the remaining bytes cannot hold as many.
  size_t count(size_t items, size_t bytes) {
    auto n = static_cast<uint32_t>(items);
    raw(&n, sizeof n);
    if (!reads_ || n <= in_.remaining() / bytes) return n;
    in_.bytes(in_.remaining() + 1);  // marks the input as incomplete
    return 0;
  }
  bool has(bool value) { return count(value, 1) > 0; }

  template <class T>
  void visit(T& value) {
    if constexpr (requires { fields(*this, value); }) {
      fields(*this, value);
    } else {
      static_assert(std::is_trivially_copyable_v<T>, "declare fields(Archive&, T&)");
      raw(&value, sizeof value);
    }
  }
  void visit(std::string& text) {
    text.resize(count(text.size(), 1));
    raw(text.data(), text.size());
  }
  template <class T>
  void visit(std::vector<T>& list) {
    constexpr bool kRaw = std::is_trivially_copyable_v<T> && !requires(T & item) { fields(*this, item); };
    list.resize(count(list.size(), kRaw ? sizeof(T) : 1));
    if constexpr (kRaw)
      raw(list.data(), list.size() * sizeof(T));
    else
      for (T& item : list) visit(item);
  }
  template <class K, class V>
  void visit(std::map<K, V>& map) {
    const size_t n = count(map.size(), 1);
    if (reads_) map.clear();
    auto entry = map.begin();
    for (size_t i = 0; i < n; ++i) {
      K key = reads_ ? K() : entry->first;
      visit(key);
      visit(reads_ ? map[key] : (entry++)->second);
    }
  }
  template <class T>
  void visit(std::optional<T>& value) {
    if (!has(value.has_value())) return value.reset();
    if (reads_) value.emplace();
    visit(*value);
  }
  template <class T>
  void visit(std::shared_ptr<const T>& value) {
    if (!has(value != nullptr)) return value.reset();
    if (reads_) value = std::make_shared<T>();
    visit(const_cast<T&>(*value));
  }

  ByteWriter out_;
  ByteReader in_{std::span<const uint8_t>()};
  bool reads_ = false;
};

inline void fields(Archive& a, Image& i) { a(i.width, i.height, i.channels, i.pixels); }
inline void fields(Archive& a, MeshTopology& t) { a(t.vertex_count, t.uvs, t.face_vertices, t.face_uvs); }
inline void fields(Archive& a, PinholeCamera& c) {
  a(c.name, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.cam_from_world);
}

template <class T>
std::vector<uint8_t> bytesOf(const T& value) {
  Archive archive;
  archive(const_cast<T&>(value));  // writing leaves the value unchanged
  return archive.take();
}

// False if the bytes are not exactly one value.
template <class T>
bool readBytes(std::span<const uint8_t> bytes, T& value) {
  Archive archive(bytes);
  archive(value);
  return archive.complete();
}

}  // namespace fourdvt::store
