// SPDX-License-Identifier: Apache-2.0
// Manifests as lines "POINTER=nNUMBER", "POINTER=sTEXT" or "POINTER=bT" below the extension: accepted values are safe
// for allocation and indexing.
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "package/character.h"

using namespace fourdvt;
using namespace fourdvt::package;

namespace {

FlatJson parse(std::string_view text) {
  FlatJson json;
  json.set("/asset/version", std::string("2.0"));
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const size_t equals = line.find('=');
    if (equals == std::string_view::npos || equals + 1 >= line.size()) continue;
    const std::string pointer = std::string("/extensions/") + kExtensionName + std::string(line.substr(0, equals));
    const std::string value(line.substr(equals + 2));
    if (line[equals + 1] == 'n') json.set(pointer, std::strtod(value.c_str(), nullptr));
    if (line[equals + 1] == 's') json.set(pointer, value);
    if (line[equals + 1] == 'b') json.set(pointer, value == "T");
  }
  return json;
}

void require(bool condition) {
  if (!condition) std::abort();
}

void checkUri(const std::string& uri) {
  require(!uri.empty() && uri[0] != '/' && uri.back() != '/' && uri.find("//") == std::string::npos);
  for (const char c : uri) require(std::isalnum(static_cast<unsigned char>(c)) || std::strchr("._-/", c));
  const std::string path = "/" + uri + "/";
  require(path.find("/./") == std::string::npos && path.find("/../") == std::string::npos);
}

void checkRoom(const Room& room) {
  checkUri(room.picture_uri);
  require(room.width >= 1 && room.width <= kMaxPictureSide && room.height >= 1 && room.height <= kMaxPictureSide);
  for (const Rect& face : room.faces) {
    require(face.x >= 0 && face.y >= 0 && face.width > 0 && face.x + face.width <= room.width && face.height > 0 &&
            face.y + face.height <= room.height);
  }
  for (int k = 0; k < 3; ++k) require(std::isfinite(room.box.min[k]) && room.box.min[k] <= room.box.max[k]);
}

void checkSpace(const Sequence& s) {
  require(!s.members.empty() && s.members.size() <= size_t(kMaxMembers) &&
          s.reference_count <= uint32_t(kMaxReferences));
  require(s.isClass() == !s.space.names.empty() && s.isClass() == !s.space.simplices.empty());
  require(s.space.names.size() <= size_t(kMaxParameters));
  for (const Member& m : s.members) {
    require(m.parameter.size() == s.space.names.size() && m.duration_s > 0 && std::isfinite(m.duration_s));
    require(std::isfinite(m.travel.x + m.travel.y + m.travel.z));
  }
  for (const ParameterSample& sample : s.space.samples) {
    require(sample.at.size() == s.space.names.size() && sample.weights.size() == s.members.size() &&
            sample.offsets.size() == s.reference_count);
    float sum = 0;
    for (float weight : sample.weights) sum += weight;
    require(std::abs(sum - 1) < 0.002f);
    for (float offset : sample.offsets) require(std::isfinite(offset));
  }
  for (const auto& simplex : s.space.simplices) {
    for (uint16_t corner : simplex) require(corner < s.space.samples.size());
  }
}

void checkSequence(const Sequence& s, int layers) {
  require(s.frame_count >= 1 && s.fps > 0 && std::isfinite(s.duration_s()) && !s.renditions.empty());
  require(s.stream_header_bytes <= s.stream_bytes);
  checkUri(s.stream_uri);
  checkSpace(s);
  if (layers == 0) {
    require(!s.isClass() && s.layout_width >= 1 && s.layout_width <= kMaxLayoutSide && s.layout_height >= 1 &&
            s.layout_height <= kMaxLayoutSide);
  }
  for (const Rendition& r : s.renditions) {
    checkUri(r.video_uri);
    require(int(r.layers.size()) == layers * int(s.members.size()) && r.width <= kMaxPictureSide &&
            r.height <= kMaxPictureSide);
    std::vector<Rect> rects = r.layers;
    if (layers == 0) rects.push_back(r.tiles);
    for (const Rect& rect : rects) {
      require(rect.x >= 0 && rect.y >= 0 && rect.width > 0 && rect.x + rect.width <= r.width &&
              rect.y + rect.height <= r.height);
    }
    require(r.barcode.rect.x + 32 * r.barcode.cell_size <= r.width);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto read = readManifest(parse({reinterpret_cast<const char*>(data), size}));
  if (!read.ok()) return 0;
  const Character& c = read.value();
  const bool from_cameras = c.appearance == AppearanceKind::Cameras;
  require(from_cameras == (c.version == kCameraFormatVersion) && from_cameras == (c.layer_count == 0));
  require(c.layer_count >= 0 && c.layer_count <= kMaxLayers && c.cameras.size() <= size_t(kMaxCameras));
  checkUri(c.mesh_uri);
  if (!c.graph_uri.empty()) checkUri(c.graph_uri);
  if (!c.room.picture_uri.empty()) checkRoom(c.room);
  for (const PinholeCamera& camera : c.cameras) require(std::isfinite(camera.centreInWorld().x) && camera.fx > 0);
  for (const Sequence& s : c.sequences) checkSequence(s, c.layer_count);
  return 0;
}
