// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "capture/gltf.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr uint64_t kMaxBytes = uint64_t{1} << 30;  // 1 GiB per buffer
constexpr uint64_t kInt8 = 5120, kUInt8 = 5121, kInt16 = 5122, kUInt16 = 5123, kUInt32 = 5125, kFloat = 5126;

uint64_t componentBytes(uint64_t type) {
  switch (type) {
    case kInt8:
    case kUInt8:
      return 1;
    case kInt16:
    case kUInt16:
      return 2;
    case kUInt32:
    case kFloat:
      return 4;
  }
  return 0;
}

template <class T>
double numberAt(const uint8_t* bytes, bool normalized) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return normalized ? std::max(-1.0, double(value) / double(std::numeric_limits<T>::max())) : double(value);
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  c = static_cast<char>(c | 0x20);
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

// Decodes percent escapes: "a%20b" → "a b".
std::string percentDecoded(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool escape =
        text[i] == '%' && i + 2 < text.size() && hexDigit(text[i + 1]) >= 0 && hexDigit(text[i + 2]) >= 0;
    out.push_back(escape ? static_cast<char>(hexDigit(text[i + 1]) * 16 + hexDigit(text[i + 2])) : text[i]);
    if (escape) i += 2;
  }
  return out;
}

// Values by character; 64: no digit.
constexpr std::array<uint8_t, 256> base64Digits() {
  std::array<uint8_t, 256> digits{};
  digits.fill(64);
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < kDigits.size(); ++i) digits[static_cast<uint8_t>(kDigits[i])] = static_cast<uint8_t>(i);
  return digits;
}

// Returns false for invalid base64.
bool base64Decoded(std::string_view text, std::string& out) {
  constexpr auto kDigits = base64Digits();
  while (text.ends_with('=')) text.remove_suffix(1);
  out.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const uint32_t digit = kDigits[static_cast<uint8_t>(c)];
    if (digit == 64) return false;
    bits = (bits << 6 | digit) & 0xffff;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    out.push_back(static_cast<char>(bits >> held & 0xff));
  }
  return true;
}

uint64_t componentsOf(std::string_view type) {
  if (type == "MAT4") return 16;
  return type.starts_with("VEC") ? static_cast<uint64_t>(type.back() - '0') : 1;
}

}  // namespace

const Json& gltfEntry(const Json& root, const char* key, std::optional<uint64_t> index) {
  static const Json null;
  const Json& list = jsonMember(root, key);
  return index && list.is_array() && *index < list.size() ? list[*index] : null;
}

std::optional<uint64_t> gltfNumber(const Json& node, const char* key) {
  const Json& value = jsonMember(node, key);
  if (!value.is_number()) return std::nullopt;
  const double number = value.get<double>();
  if (!(number >= 0) || number > 9e15 || number != std::floor(number)) return std::nullopt;
  return static_cast<uint64_t>(number);
}

double GltfNumbers::Elements::at(uint64_t i, int c, bool normalized) const {
  const uint8_t* bytes = data + i * stride + static_cast<uint64_t>(c) * componentBytes(type);
  switch (type) {
    case kInt8:
      return numberAt<int8_t>(bytes, normalized);
    case kUInt8:
      return numberAt<uint8_t>(bytes, normalized);
    case kInt16:
      return numberAt<int16_t>(bytes, normalized);
    case kUInt16:
      return numberAt<uint16_t>(bytes, normalized);
    case kUInt32:
      return numberAt<uint32_t>(bytes, false);
    default:
      return numberAt<float>(bytes, false);
  }
}

double GltfNumbers::at(uint64_t i, int c) const {
  uint64_t low = 0, high = sparse_count_;
  while (low < high) {  // binary search for the first index not below i
    const uint64_t middle = (low + high) / 2;
    if (sparse_indices_.at(middle, 0, false) < static_cast<double>(i))
      low = middle + 1;
    else
      high = middle;
  }
  if (low < sparse_count_ && sparse_indices_.at(low, 0, false) == static_cast<double>(i))
    return sparse_values_.at(low, c, normalized_);
  return elements_.data ? elements_.at(i, c, normalized_) : 0;
}

Error GltfBytes::error(const std::string& what) const {
  return {ErrorId::FileUnreadable, path_ + ": " + what + "; export the mesh again"};
}

Error GltfBytes::unsupported(const std::string& what) const { return {ErrorId::Unsupported, path_ + ": " + what}; }

Result<GltfBytes> GltfBytes::open(std::string_view json, std::string_view glb_buffer, const std::string& path) {
  GltfBytes bytes(path);
  bytes.glb_buffer_ = glb_buffer;
  bytes.size_ = json.size() + glb_buffer.size();
  constexpr int kMaxDepth = 64;  // maximum nesting: JSON writers recurse
  bool deep = false;
  const auto shallow = [&](int depth, Json::parse_event_t, const Json&) { return !(deep |= depth > kMaxDepth); };
  bytes.root_ = Json::parse(json.begin(), json.end(), shallow, false);
  if (deep) return bytes.unsupported("has JSON nested deeper than 64; take such fields out");
  if (!bytes.root_.is_object()) return bytes.error("its JSON cannot be read (truncated or damaged)");
  if (!jsonText(jsonMember(jsonMember(bytes.root_, "asset"), "version")).starts_with("2."))
    return bytes.unsupported("is no glTF 2.0; export the mesh as glTF 2.0");
  const Json& buffers = jsonMember(bytes.root_, "buffers");
  if (buffers.is_array()) bytes.buffers_.resize(buffers.size());
  return bytes;
}

Status GltfBytes::checkExtensions(const Json& node) const {
  const Json& extensions = jsonMember(node, "extensions");
  struct Refused {
    const char *name, *why;
  };
  for (const Refused& refused :
       {Refused{"KHR_draco_mesh_compression", "is compressed with Draco; export without compression"},
        Refused{"EXT_meshopt_compression", "is compressed with meshopt; export without compression"},
        Refused{"KHR_meshopt_compression", "is compressed with meshopt; export without compression"},
        Refused{"EXT_mesh_gpu_instancing", "repeats meshes as instances; export them as one mesh"}}) {
    if (!jsonMember(extensions, refused.name).is_null()) return unsupported(refused.why);
  }
  return {};
}

Result<GltfNumbers> GltfBytes::accessor(std::optional<uint64_t> index, const char* type, const char* what) {
  const Json& a = gltfEntry(root_, "accessors", index);
  const Error broken = error(std::string(what) + " cannot be read (damaged or truncated)");
  GltfNumbers out;
  const uint64_t components = componentsOf(type), component = gltfNumber(a, "componentType").value_or(0);
  out.count_ = gltfNumber(a, "count").value_or(0);
  const Json& normalized = jsonMember(a, "normalized");
  out.normalized_ = normalized.is_boolean() && normalized.get<bool>();
  out.elements_.type = component;
  const Json& overlay = jsonMember(a, "sparse");
  if (jsonMember(a, "type") != type || out.count_ == 0 || (overlay.is_null() && jsonMember(a, "bufferView").is_null()))
    return broken;
  if (!jsonMember(a, "bufferView").is_null()) {
    FOURDVT_ASSIGN(const bool fits, elements(a, out.count_, components, component, out.elements_));
    if (!fits) return broken;
  }
  if (overlay.is_null()) return out;
  FOURDVT_ASSIGN(const bool fits, sparse(overlay, components, out));
  if (!fits || out.count_ > size_) return broken;  // implicit zeros count as stored ones
  return out;
}

Result<bool> GltfBytes::elements(const Json& source, uint64_t count, uint64_t components, uint64_t type,
                                 GltfNumbers::Elements& out) {
  const Json& view = gltfEntry(root_, "bufferViews", gltfNumber(source, "bufferView"));
  if (!view.is_object()) return false;
  FOURDVT_TRY(checkExtensions(view));
  FOURDVT_ASSIGN(const std::string_view data, buffer(gltfNumber(view, "buffer")));
  const uint64_t element = componentBytes(type) * components;
  const uint64_t stride = gltfNumber(view, "byteStride").value_or(0);
  out.type = type;
  out.stride = stride > 0 ? stride : element;
  const uint64_t view_at = gltfNumber(view, "byteOffset").value_or(0),
                 at = gltfNumber(source, "byteOffset").value_or(0);
  const uint64_t view_bytes = gltfNumber(view, "byteLength").value_or(0);
  if (element == 0 || out.stride < element || out.stride > 252 || count == 0 || view_at > data.size() ||
      view_bytes > data.size() - view_at || at > view_bytes || (count - 1) * out.stride + element > view_bytes - at)
    return false;
  out.data = reinterpret_cast<const uint8_t*>(data.data()) + view_at + at;
  return true;
}

Result<bool> GltfBytes::sparse(const Json& node, uint64_t components, GltfNumbers& out) {
  const Json &indices = jsonMember(node, "indices"), &values = jsonMember(node, "values");
  const uint64_t count = gltfNumber(node, "count").value_or(0);
  FOURDVT_ASSIGN(const bool has_indices,
                 elements(indices, count, 1, gltfNumber(indices, "componentType").value_or(0), out.sparse_indices_));
  FOURDVT_ASSIGN(const bool has_values, elements(values, count, components, out.elements_.type, out.sparse_values_));
  if (!has_indices || !has_values) return false;
  out.sparse_count_ = count;
  double before = -1;
  for (uint64_t i = 0; i < count; ++i) {
    const double index = out.sparse_indices_.at(i, 0, false);
    if (!(index > before) || index >= static_cast<double>(out.count_)) return false;
    before = index;
  }
  return true;
}

Result<std::string_view> GltfBytes::buffer(std::optional<uint64_t> index) {
  const Json& node = gltfEntry(root_, "buffers", index);
  if (!node.is_object()) return error("a buffer is missing (damaged or truncated)");
  const uint64_t length = gltfNumber(node, "byteLength").value_or(0);
  const Json& uri = jsonMember(node, "uri");
  std::string_view data = glb_buffer_;
  if (uri.is_string()) {
    std::optional<std::string>& loaded = buffers_[*index];
    if (!loaded) {
      loaded.emplace();
      FOURDVT_TRY(load(uri.get<std::string>(), *loaded));
    }
    data = *loaded;
  }
  if (length > data.size()) return error("a buffer is shorter than it says (truncated)");
  return data.substr(0, length);
}

Status GltfBytes::load(const std::string& uri, std::string& out) {
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(";base64,");
    if (comma == std::string::npos || !base64Decoded(std::string_view(uri).substr(comma + 8), out))
      return error("a buffer's data cannot be decoded");
  } else {
    const std::filesystem::path name = percentDecoded(uri);
    const bool leaves = std::find(name.begin(), name.end(), "..") != name.end();
    if (name.empty() || name.is_absolute() || leaves || uri.find("://") != std::string::npos)
      return unsupported("names a buffer outside its folder; export it as .glb");
    std::error_code failed;
    const std::filesystem::path real = std::filesystem::canonical(path_, failed);  // buffers lie beside a link's target
    const std::filesystem::path file = (failed ? std::filesystem::path(path_) : real).parent_path() / name;
    const uint64_t bytes = std::filesystem::file_size(file, failed);
    if (!failed && bytes > kMaxBytes) return unsupported("has a buffer larger than 1 GiB; reduce the mesh's triangles");
    auto text = failed ? std::nullopt : readText(file.string());
    if (!text) {
      return Error{ErrorId::FileMissing,
                   file.string() + ": cannot be read, but " + path_ + " names it; add it, or export as .glb"};
    }
    out = std::move(*text);
  }
  size_ += out.size();
  if (size_ > 2 * kMaxBytes) return unsupported("has buffers of more than 2 GiB; reduce the mesh's triangles");
  return {};
}

}  // namespace fourdvt::capture
