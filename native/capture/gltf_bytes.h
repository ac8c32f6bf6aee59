// SPDX-License-Identifier: Apache-2.0
// Bytes of a glTF 2.0 file: its JSON, buffers and accessors, all bounds checked.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace fourdvt::capture {

using Json = nlohmann::json;

// Value of `key`; null if missing or if `node` is no object.
const Json& gltfMember(const Json& node, const char* key);
// Entry `index` of the list root[key]; null if missing.
const Json& gltfEntry(const Json& root, const char* key, std::optional<uint64_t> index);
// Non-negative integer that is exact as a double; nullopt for anything else.
std::optional<uint64_t> gltfNumber(const Json& node, const char* key);
// Reads a list of exactly `count` finite numbers; false for anything else.
bool gltfNumbers(const Json& node, size_t count, double* out);

// View of numbers in a buffer, borrowed from the GltfBytes.
class GltfNumbers {
 public:
  uint64_t count() const { return count_; }
  // Component `c` of element `i`; a normalised integer lies in [-1,1].
  double at(uint64_t i, int c) const;

 private:
  friend class GltfBytes;
  struct Elements {
    const uint8_t* data = nullptr;
    uint64_t stride = 0, type = 0;  // component type by its glTF number
    double at(uint64_t i, int c, bool normalized) const;
  };
  Elements elements_;  // null data: zeros
  uint64_t count_ = 0, sparse_count_ = 0;
  Elements sparse_indices_, sparse_values_;  // indices, ascending, and values of the sparse elements
  bool normalized_ = false;
};

class GltfBytes {
 public:
  // `path`: for messages, and for the folder of files named by the JSON. `glb_buffer` must outlive the result.
  static Result<GltfBytes> open(std::string_view json, std::string_view glb_buffer, const std::string& path);

  const Json& root() const { return root_; }
  const std::string& path() const { return path_; }
  // Bytes of the file and of the buffers used so far.
  uint64_t size() const { return size_; }
  Error error(const std::string& what) const;        // FileUnreadable
  Error unsupported(const std::string& what) const;  // Unsupported
  Status checkExtensions(const Json& node) const;    // Unsupported: compressed data, instances
  // `type`: SCALAR, VEC2, VEC3, VEC4 or MAT4. `what` is for messages.
  Result<GltfNumbers> accessor(std::optional<uint64_t> index, const char* type, const char* what);

 private:
  // Reads `count` elements of a buffer view, at byteOffset of `source`. False if they do not fit.
  Result<bool> elements(const Json& source, uint64_t count, uint64_t components, uint64_t type,
                        GltfNumbers::Elements& out);
  Result<bool> sparse(const Json& node, uint64_t components, GltfNumbers& out);
  explicit GltfBytes(const std::string& path) : path_(path) {}
  Result<std::string_view> buffer(std::optional<uint64_t> index);
  Status load(const std::string& uri, std::string& out);

  std::string path_;
  Json root_;
  std::string_view glb_buffer_;
  std::vector<std::optional<std::string>> buffers_;  // used buffers outside the GLB
  uint64_t size_ = 0;
};

}  // namespace fourdvt::capture
