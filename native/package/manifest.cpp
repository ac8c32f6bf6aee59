// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <set>

#include "package/character.h"

namespace fourdvt::package {
namespace {

constexpr double kMaxCount = 1 << 22;  // vertices, faces
constexpr double kMaxFrames = 1 << 20;
constexpr double kMaxBytes = 9007199254740992.0;  // 2^53, exact in JSON
constexpr double kMaxHeaderBytes = 64 << 20;
constexpr int kMaxSequences = 256, kMaxRenditions = 16;
constexpr double kMaxMetres = 1e6;

// Relative, inside the character folder: no scheme, no leading slash, no ".." segment, no control characters.
bool isSafeUri(const std::string& uri) {
  if (uri.empty() || uri.size() > 512 || uri[0] == '/') return false;
  size_t segment = 0;
  for (size_t i = 0; i <= uri.size(); ++i) {
    const char c = i < uri.size() ? uri[i] : '/';
    if (c == ':' || c == '\\' || static_cast<unsigned char>(c) < 0x20) return false;
    if (c == '?' || c == '#') return false;
    if (c != '/') continue;
    if (uri.compare(segment, i - segment, "..") == 0) return false;
    segment = i + 1;
  }
  return true;
}

// Reads fields below a pointer and keeps the first complaint.
class FieldReader {
 public:
  explicit FieldReader(const FlatJson& json) : json_(json) {}
  bool ok() const { return problem_.empty(); }
  const std::string& problem() const { return problem_; }
  void fail(const std::string& pointer, const std::string& what) {
    if (ok()) problem_ = pointer + " " + what;
  }
  double number(const std::string& pointer, double low, double high) {
    const auto value = json_.number(pointer);
    if (!value) return fail(pointer, "is missing or not a number"), low;
    if (!(*value >= low && *value <= high)) return fail(pointer, "is out of range"), low;
    return *value;
  }
  double integer(const std::string& pointer, double low, double high) {
    const double value = number(pointer, low, high);
    if (value != std::floor(value)) fail(pointer, "is not a whole number");
    return value;
  }
  std::string text(const std::string& pointer, size_t max_length) {
    const auto value = json_.string(pointer);
    if (!value || value->empty()) return fail(pointer, "is missing or not a string"), std::string();
    if (value->size() > max_length) return fail(pointer, "is too long"), std::string();
    return *value;
  }
  std::string uri(const std::string& pointer) {
    std::string value = text(pointer, 512);
    if (ok() && !isSafeUri(value)) fail(pointer, "must be a relative path inside the character folder");
    return value;
  }
  glm::dvec3 vec3(const std::string& pointer) {
    glm::dvec3 v;
    for (int i = 0; i < 3; ++i) v[i] = number(pointer + "/" + std::to_string(i), -kMaxMetres, kMaxMetres);
    return v;
  }
  Rect rect(const std::string& pointer) {
    int v[4];
    for (int i = 0; i < 4; ++i) v[i] = int(integer(pointer + "/" + std::to_string(i), 0, kMaxPictureSide));
    return {v[0], v[1], v[2], v[3]};
  }
  bool flag(const std::string& pointer) {
    const auto value = json_.boolean(pointer);
    if (!value) fail(pointer, "is missing or not true/false");
    return value.value_or(false);
  }
  // Length of an array of objects; complains outside [low, high].
  int arraySize(const std::string& pointer, int low, int high) {
    int count = 0;
    while (count <= high && json_.has(pointer + "/" + std::to_string(count))) ++count;
    if (count < low || count > high)
      fail(pointer, "must have " + std::to_string(low) + " to " + std::to_string(high) + " entries");
    return ok() ? count : 0;
  }

 private:
  const FlatJson& json_;
  std::string problem_;
};

bool isRigid(const glm::dmat4& m) {
  const glm::dmat3 r(m);
  const glm::dmat3 product = glm::transpose(r) * r;
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < 3; ++i) {
      if (!(std::abs(product[c][i] - (c == i ? 1.0 : 0.0)) < 1e-3)) return false;
    }
  }
  return glm::determinant(r) > 0 && m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1;
}

PinholeCamera readCamera(FieldReader& in, const std::string& at) {
  PinholeCamera camera;
  camera.name = in.text(at + "/name", 128);
  camera.width = int(in.integer(at + "/width", 1, 65536));
  camera.height = int(in.integer(at + "/height", 1, 65536));
  camera.fx = in.number(at + "/fx", 1e-3, 1e7);
  camera.fy = in.number(at + "/fy", 1e-3, 1e7);
  camera.cx = in.number(at + "/cx", -1e6, 1e6);
  camera.cy = in.number(at + "/cy", -1e6, 1e6);
  for (int i = 0; i < 16; ++i) {
    camera.cam_from_world[i / 4][i % 4] = in.number(at + "/camFromWorld/" + std::to_string(i), -kMaxMetres, kMaxMetres);
  }
  if (in.ok() && !isRigid(camera.cam_from_world)) in.fail(at + "/camFromWorld", "is not a rotation and translation");
  return camera;
}

bool inside(const Rect& r, int width, int height) {
  return r.width > 0 && r.height > 0 && r.x + r.width <= width && r.y + r.height <= height;
}

Rendition readRendition(FieldReader& in, const std::string& at, int layer_count) {
  Rendition rendition;
  rendition.video_uri = in.uri(at + "/uri");
  rendition.video_bytes = uint64_t(in.integer(at + "/byteLength", 1, kMaxBytes));
  rendition.codec = in.text(at + "/codec", 64);
  rendition.width = int(in.integer(at + "/width", 2, kMaxPictureSide));
  rendition.height = int(in.integer(at + "/height", 2, kMaxPictureSide));
  if (rendition.width % 2 || rendition.height % 2) in.fail(at, "width and height must be even");
  const int layers = in.arraySize(at + "/layers", layer_count, layer_count);
  for (int l = 0; l < layers; ++l) {
    const Rect r = in.rect(at + "/layers/" + std::to_string(l));
    if (!inside(r, rendition.width, rendition.height) || r.width != r.height) {
      in.fail(at + "/layers", "must be squares inside the picture");
    }
    rendition.layers.push_back(r);
  }
  rendition.barcode.rect = in.rect(at + "/barcode/rect");
  rendition.barcode.cell_size = int(in.integer(at + "/barcode/cellSize", 2, 64));
  if (!inside(rendition.barcode.rect, rendition.width, rendition.height) ||
      rendition.barcode.rect.width != 32 * rendition.barcode.cell_size) {
    in.fail(at + "/barcode", "must be 32 cells wide and inside the picture");
  }
  return rendition;
}

Sequence readSequence(FieldReader& in, const std::string& at, int layer_count) {
  Sequence s;
  s.name = in.text(at + "/name", 128);
  s.frame_count = uint32_t(in.integer(at + "/frameCount", 1, kMaxFrames));
  s.fps = in.number(at + "/fps", 0.1, 1000);
  s.loop = in.flag(at + "/loop");
  s.root_velocity_mps = in.vec3(at + "/rootVelocity");
  s.stream_uri = in.uri(at + "/stream/uri");
  s.stream_bytes = uint64_t(in.integer(at + "/stream/byteLength", 1, kMaxBytes));
  s.stream_header_bytes = uint32_t(in.integer(at + "/stream/headerLength", 1, kMaxHeaderBytes));
  if (s.stream_header_bytes > s.stream_bytes) in.fail(at + "/stream/headerLength", "exceeds the stream");
  const int renditions = in.arraySize(at + "/renditions", 1, kMaxRenditions);
  for (int r = 0; r < renditions; ++r) {
    s.renditions.push_back(readRendition(in, at + "/renditions/" + std::to_string(r), layer_count));
  }
  return s;
}

void readCharacter(FieldReader& in, const std::string& at, Character& c) {
  c.name = in.text(at + "/name", 128);
  c.layer_count = int(in.integer(at + "/layerCount", 1, kMaxLayers));
  c.vertex_count = uint32_t(in.integer(at + "/vertexCount", 3, kMaxCount));
  c.face_count = uint32_t(in.integer(at + "/faceCount", 1, kMaxCount));
  c.mesh_uri = in.uri(at + "/mesh/uri");
  c.mesh_offset = uint64_t(in.integer(at + "/mesh/byteOffset", 0, kMaxBytes));
  c.mesh_bytes = uint64_t(in.integer(at + "/mesh/byteLength", 1, 1 << 28));
  c.poster_uri = in.uri(at + "/poster/uri");
  c.bounds.min = glm::vec3(in.vec3(at + "/bounds/min"));
  c.bounds.max = glm::vec3(in.vec3(at + "/bounds/max"));
  if (!glm::all(glm::lessThanEqual(c.bounds.min, c.bounds.max))) in.fail(at + "/bounds", "has min above max");
  c.ground_y_m = in.number(at + "/groundY", -kMaxMetres, kMaxMetres);
  const int cameras = in.arraySize(at + "/cameras", 1, kMaxCameras);
  for (int k = 0; k < cameras; ++k) c.cameras.push_back(readCamera(in, at + "/cameras/" + std::to_string(k)));
  std::set<std::string> names;
  const int sequences = in.arraySize(at + "/sequences", 1, kMaxSequences);
  for (int s = 0; s < sequences && in.ok(); ++s) {
    const std::string here = at + "/sequences/" + std::to_string(s);
    c.sequences.push_back(readSequence(in, here, c.layer_count));
    if (!names.insert(c.sequences.back().name).second) in.fail(here + "/name", "appears twice");
  }
}

Error invalid(const std::string& problem) {
  return {ErrorId::ManifestInvalid,
          "character.gltf: " + problem + "; bake the character again or upload all its files"};
}

}  // namespace

const Sequence* Character::find(const std::string& sequence_name) const {
  for (const Sequence& s : sequences) {
    if (s.name == sequence_name) return &s;
  }
  return nullptr;
}

Result<Character> readManifest(const FlatJson& gltf) {
  const std::string at = std::string("/extensions/") + kExtensionName;
  if (gltf.string("/asset/version").value_or("") != "2.0") return invalid("is not glTF 2.0");
  if (!gltf.has(at)) return invalid(std::string("has no extension ") + kExtensionName + ": not a fourdvt character");
  FieldReader in(gltf);
  Character character;
  character.version = int(in.integer(at + "/version", 1, 1 << 20));
  if (in.ok() && character.version > kFormatVersion) {
    return Error{ErrorId::Unsupported, "character.gltf: format version " + std::to_string(character.version) +
                                           " is newer than this player; update the player"};
  }
  if (in.ok()) readCharacter(in, at, character);
  if (!in.ok()) return invalid(in.problem());
  return character;
}

}  // namespace fourdvt::package
