// SPDX-License-Identifier: Apache-2.0
// The bytes of a glTF 2.0 file: its JSON, its buffers and its accessors, all bounds checked. Does NOT know meshes.
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

// The value of `key`; null if there is none or if `node` is no object.
const Json& gltfMember(const Json& node, const char* key);
// Entry `index` of the list root[key]; null if there is none.
const Json& gltfEntry(const Json& root, const char* key, std::optional<uint64_t> index);
// A whole number from 0 that is exact as a double; nullopt for anything else.
std::optional<uint64_t> gltfNumber(const Json& node, const char* key);
// `out` numbers in a list; false if it is none of as many finite ones.
bool gltfNumbers(const Json& node, size_t count, double* out);

// Numbers in a buffer, borrowed from the GltfBytes.
class GltfNumbers {
 public:
  uint64_t count() const { return count_; }
  // Component `c` of element `i`; a normalised integer lies in [-1,1].
  double at(uint64_t i, int c) const;

 private:
  friend class GltfBytes;
  struct Elements {
    const uint8_t* data = nullptr;
    uint64_t stride = 0, type = 0;  // the component type by its number in glTF
    double at(uint64_t i, int c, bool normalized) const;
  };
  Elements elements_;  // no data: zeros
  uint64_t count_ = 0, sparse_count_ = 0;
  Elements sparse_indices_, sparse_values_;  // elements, in ascending order, that are other than elements_ has them
  bool normalized_ = false;
};

class GltfBytes {
 public:
  // `path` is for messages, and for the folder of the files that the JSON names. `glb_buffer` must outlive this.
  static Result<GltfBytes> open(std::string_view json, std::string_view glb_buffer, const std::string& path);

  const Json& root() const { return root_; }
  const std::string& path() const { return path_; }
  // Bytes of the file and of the buffers that were used so far.
  uint64_t size() const { return size_; }
  Error error(const std::string& what) const;        // FileUnreadable
  Error unsupported(const std::string& what) const;  // Unsupported
  Status checkExtensions(const Json& node) const;    // Unsupported: compressed data, instances
  // `type`: SCALAR, VEC2, VEC3, VEC4 or MAT4. `what` is for messages.
  Result<GltfNumbers> accessor(std::optional<uint64_t> index, const char* type, const char* what);

 private:
  // `count` elements of a buffer view, at byteOffset of `source`. False if they do not fit.
  Result<bool> elements(const Json& source, uint64_t count, uint64_t components, uint64_t type,
                        GltfNumbers::Elements& out);
  Result<bool> sparse(const Json& node, uint64_t components, GltfNumbers& out);
  explicit GltfBytes(const std::string& path) : path_(path) {}
  Result<std::string_view> buffer(std::optional<uint64_t> index);
  Status load(const std::string& uri, std::string& out);

  std::string path_;
  Json root_;
  std::string_view glb_buffer_;
  std::vector<std::optional<std::string>> buffers_;  // those that were used and are not in the GLB
  uint64_t size_ = 0;
};

}  // namespace fourdvt::capture
