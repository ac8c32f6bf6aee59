// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include "package/chunk_counts.h"
#include "package/field_reader.h"

namespace fourdvt::package {
namespace {

constexpr int kMaxSamples = 4096, kMaxSimplices = 8192;
constexpr double kMaxDuration_s = 1e6, kMaxParameter = 1e6, kMaxCoefficient = 1000;
constexpr double kWeightSlack = 1e-3;  // tolerance of single weights and of their sum

std::vector<float> readFactors(FieldReader& in, const std::string& at, size_t count, double low, double high) {
  const std::vector<double> numbers = in.numbers(at, count, low, high);
  return {numbers.begin(), numbers.end()};
}

ParameterSample readSample(FieldReader& in, const std::string& at, const Sequence& s) {
  ParameterSample sample;
  sample.at = in.numbers(at, "/at", s.space.names.size(), -kMaxParameter, kMaxParameter);
  sample.weights = readFactors(in, at + "/weights", s.members.size(), -kWeightSlack, 1 + kWeightSlack);
  sample.offsets = readFactors(in, at + "/offsets", s.reference_count, -kMaxCoefficient, kMaxCoefficient);
  double sum = 0;
  for (float weight : sample.weights) sum += weight;
  if (in.ok() && !(std::abs(sum - 1) <= kWeightSlack)) in.fail(at, "/weights", "must add up to 1");
  for (float& weight : sample.weights) weight = std::clamp(weight, 0.0f, 1.0f);  // the renderer refuses negative ones
  return sample;
}

// Length of an interval, or twice the area of a triangle: divisor of look-ups.
double extent(const ParameterSpace& space, const std::array<uint16_t, 3>& simplex) {
  const auto &a = space.samples[simplex[0]].at, &b = space.samples[simplex[1]].at, &c = space.samples[simplex[2]].at;
  if (a.size() == 1) return b[0] - a[0];
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

void readSimplex(FieldReader& in, const std::string& at, ParameterSpace& space) {
  std::array<uint16_t, 3> simplex{};
  for (int i = 0; i < 3; ++i)
    simplex[size_t(i)] = uint16_t(in.integer(item(at, i), 0, double(space.samples.size()) - 1));
  if (!in.ok()) return;
  if (space.names.size() == 1 && simplex[1] != simplex[2]) in.fail(at, "must repeat its second index");
  if (!(std::abs(extent(space, simplex)) > 1e-9)) in.fail(at, "has no extent");
  space.simplices.push_back(simplex);
}

void readSpace(FieldReader& in, const std::string& at, Sequence& s) {
  const int samples = in.arraySize(at, "/samples", 2, kMaxSamples);
  for (int i = 0; i < samples && in.ok(); ++i) s.space.samples.push_back(readSample(in, item(at + "/samples", i), s));
  const int simplices = in.arraySize(at, "/simplices", 1, kMaxSimplices);
  for (int i = 0; i < simplices && in.ok(); ++i) readSimplex(in, item(at + "/simplices", i), s.space);
}

Member readMember(FieldReader& in, const std::string& at, size_t parameters) {
  Member member;
  member.name = in.text(at, "/name", 128);
  member.parameter = in.numbers(at, "/parameter", parameters, -kMaxParameter, kMaxParameter);
  member.duration_s = in.number(at, "/duration", 1e-3, kMaxDuration_s);
  member.travel = in.vec3(at, "/travel");
  return member;
}

std::vector<std::string> readParameterNames(FieldReader& in, const std::string& at) {
  std::vector<std::string> names;
  const int count = in.arraySize(at, 1, kMaxParameters);
  for (int i = 0; i < count; ++i) names.push_back(in.text(item(at, i), 128));
  if (names.size() == 2 && names[0] == names[1]) in.fail(at, "names a parameter twice");
  return names;
}

Member itself(const Sequence& s) {
  const double duration_s = s.duration_s();
  return {s.name, {}, duration_s, glm::dvec3(s.root_velocity_mps.x, s.root_velocity_mps.z, 0) * duration_s};
}

// Sets members, space and reference_count; requires name, frame_count, fps and root_velocity_mps. A sequence without
// members gets itself as the only one.
void readMembers(FieldReader& in, const std::string& at, Sequence& s) {
  if (!in.ok()) return;
  const int members = in.arraySize(at, "/members", 0, kMaxMembers);
  if (members > 1) s.space.names = readParameterNames(in, at + "/parameterSpace/names");
  for (int m = 0; m < members && in.ok(); ++m) {
    const std::string here = item(at + "/members", m);
    s.members.push_back(readMember(in, here, s.space.names.size()));
    for (int other = 0; other < m; ++other) {
      if (s.members[size_t(other)].name == s.members.back().name) in.fail(here, "/name", "appears twice");
    }
  }
  if (members == 0) s.members.push_back(itself(s));
  if (members <= 1) return;
  s.reference_count = uint32_t(in.integer(at, "/referenceCount", 0, kMaxReferences));
  if (in.has(at, "/detailCorrelation")) s.detail_correlation = float(in.number(at, "/detailCorrelation", 0, 1));
  readSpace(in, at + "/parameterSpace", s);
}

constexpr double kMaxBytes = 9007199254740992.0;  // 2^53, exact in JSON
constexpr double kMaxHeaderBytes = 64 << 20;
constexpr int kMaxSequences = 256;
constexpr double kMaxMeshBytes = 1 << 28, kMaxGraphBytes = 64 << 20, kMaxRoomBytes = 16 << 20,
                 kMaxStartBytes = 16 << 20;

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
  camera.name = in.text(at, "/name", 128);
  camera.width = int(in.integer(at, "/width", 1, 65536));
  camera.height = int(in.integer(at, "/height", 1, 65536));
  camera.fx = in.number(at, "/fx", 1e-3, 1e7);
  camera.fy = in.number(at, "/fy", 1e-3, 1e7);
  camera.cx = in.number(at, "/cx", -1e6, 1e6);
  camera.cy = in.number(at, "/cy", -1e6, 1e6);
  const std::vector<double> matrix = in.numbers(at, "/camFromWorld", 16, -kMaxMetres, kMaxMetres);
  for (int i = 0; i < 16; ++i) camera.cam_from_world[i / 4][i % 4] = matrix[size_t(i)];
  if (in.ok() && !isRigid(camera.cam_from_world)) in.fail(at, "/camFromWorld", "is not a rotation and translation");
  return camera;
}

bool inside(const Rect& r, int width, int height) {
  return r.width > 0 && r.height > 0 && r.x + r.width <= width && r.y + r.height <= height;
}

std::vector<Rect> readLayers(FieldReader& in, const std::string& at, int count, const Rendition& rendition) {
  std::vector<Rect> layers;
  const int squares = in.arraySize(at, count, count);
  for (int l = 0; l < squares; ++l) {
    const Rect r = in.rect(item(at, l));
    if (!inside(r, rendition.width, rendition.height) || r.width != r.height)
      in.fail(at, "must be squares inside the picture");
    layers.push_back(r);
  }
  return layers;
}

Rendition readRendition(FieldReader& in, const std::string& at, int layer_count) {
  Rendition rendition;
  rendition.video_uri = in.uri(at, "/uri");
  rendition.video_bytes = uint64_t(in.integer(at, "/byteLength", 1, kMaxBytes));
  readPicture(in, at, layer_count, rendition);
  return rendition;
}

// Reads URI, byte length and hash of a file, or of a part of one.
void readFileOf(FieldReader& in, const std::string& at, double max_bytes, std::string& uri, uint64_t& bytes,
                uint64_t& hash) {
  uri = in.uri(at, "/uri");
  bytes = uint64_t(in.integer(at, "/byteLength", 1, max_bytes));
  hash = in.hash(at, "/hash");
}

BoundingBox readBox(FieldReader& in, const std::string& at) {
  const BoundingBox box{glm::vec3(in.vec3(at, "/min")), glm::vec3(in.vec3(at, "/max"))};
  if (!glm::all(glm::lessThanEqual(box.min, box.max))) in.fail(at, "has min above max");
  return box;
}

void readRoom(FieldReader& in, const std::string& at, Room& room) {
  readFileOf(in, at, kMaxRoomBytes, room.picture_uri, room.picture_bytes, room.picture_hash);
  room.width = int(in.integer(at, "/width", 1, kMaxPictureSide));
  room.height = int(in.integer(at, "/height", 1, kMaxPictureSide));
  room.box = readBox(in, at);
  in.arraySize(at, "/faces", 6, 6);
  for (int f = 0; f < 6; ++f) {
    Rect& face = room.faces[size_t(f)] = in.rect(item(at + "/faces", f));
    if (!inside(face, room.width, room.height)) in.fail(at, "/faces", "must lie inside the picture");
  }
}

void readMethod(FieldReader& in, const std::string& at, DrawingMethod& method) {
  method.name = in.text(at, "/name", 64);
  for (const char c : method.name)
    if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'))
      in.fail(at, "/name", "must be made of a to z, 0 to 9 and -");
  if (in.has(at, "/sweepBand")) method.sweep_band_m = in.number(at, "/sweepBand", 1e-4, 1);
}

void readCoarse(FieldReader& in, const std::string& at, Sequence& s) {
  s.coarse_renditions = uint32_t(in.integer(at, "/renditions", 1, double(s.renditions.size())));
  s.coarse_bytes = uint64_t(in.integer(at, "/byteLength", 1, double(s.stream_bytes)));
}

// layer_count 0: from cameras.
Sequence readSequence(FieldReader& in, const std::string& at, int version, int layer_count) {
  Sequence s;
  s.name = in.text(at, "/name", 128);
  s.frame_count = uint32_t(in.integer(at, "/frameCount", 1, kMaxFrames));
  s.fps = in.number(at, "/fps", 0.1, 1000);
  s.loop = in.flag(at, "/loop");
  s.root_velocity_mps = in.vec3(at, "/rootVelocity");
  s.stream_uri = in.uri(at, "/stream/uri");
  s.stream_bytes = uint64_t(in.integer(at, "/stream/byteLength", 1, kMaxBytes));
  s.stream_header_bytes = uint32_t(in.integer(at, "/stream/headerLength", 1, kMaxHeaderBytes));
  s.stream_header_hash = in.hash(at, "/stream/headerHash");
  if (s.stream_header_bytes > s.stream_bytes) in.fail(at, "/stream/headerLength", "exceeds the stream");
  if (layer_count == 0) {
    if (in.has(at, "/members")) in.fail(at, "/members", "cannot be: a character from cameras has no classes");
    readLayout(in, at, s);
  }
  readMembers(in, at, s);
  const int squares = int(s.members.size()) * layer_count;
  const int renditions = in.arraySize(at, "/renditions", 1, kMaxRenditions);
  for (int r = 0; r < renditions; ++r) {
    s.renditions.push_back(readRendition(in, item(at + "/renditions", r), squares));
  }
  if (version == kCoarseFormatVersion && in.has(at, "/stream/coarse")) readCoarse(in, at + "/stream/coarse", s);
  return s;
}

void readCharacter(FieldReader& in, const std::string& at, Character& c) {
  if (c.version == kCameraFormatVersion) {
    c.appearance = AppearanceKind::Cameras;
    if (in.has(at, "/graph")) in.fail(at, "/graph", "cannot be: a character from cameras has no motion graph");
  } else {
    c.layer_count = int(in.integer(at, "/layerCount", 1, kMaxLayers));
  }
  readBody(in, at, c);
  readFileOf(in, at + "/mesh", kMaxMeshBytes, c.mesh_uri, c.mesh_bytes, c.mesh_hash);
  c.mesh_offset = uint64_t(in.integer(at, "/mesh/byteOffset", 0, kMaxBytes));
  c.poster_uri = in.uri(at, "/poster/uri");
  if (in.has(at, "/graph")) readFileOf(in, at + "/graph", kMaxGraphBytes, c.graph_uri, c.graph_bytes, c.graph_hash);
  if (in.has(at, "/room")) readRoom(in, at + "/room", c.room);
  std::set<std::string> names;
  const int sequences = in.arraySize(at, "/sequences", 1, kMaxSequences);
  for (int s = 0; s < sequences && in.ok(); ++s) {
    const std::string here = item(at + "/sequences", s);
    c.sequences.push_back(readSequence(in, here, c.version, c.layer_count));
    if (!names.insert(c.sequences.back().name).second) in.fail(here, "/name", "appears twice");
  }
  if (in.has(at, "/start")) readFileOf(in, at + "/start", kMaxStartBytes, c.start.uri, c.start.bytes, c.start.hash);
}

Error invalidManifest(const std::string& problem) {
  return {ErrorId::ManifestInvalid,
          "character.gltf: " + problem + "; bake the character again or upload all its files"};
}

}  // namespace

void readPicture(FieldReader& in, const std::string& at, int layer_count, Rendition& rendition) {
  rendition.codec = in.text(at, "/codec", 64);
  rendition.width = int(in.integer(at, "/width", 2, kMaxPictureSide));
  rendition.height = int(in.integer(at, "/height", 2, kMaxPictureSide));
  if (rendition.width % 2 || rendition.height % 2) in.fail(at, "width and height must be even");
  if (layer_count > 0) {
    rendition.layers = readLayers(in, at + "/layers", layer_count, rendition);
  } else {
    rendition.tiles = in.rect(at, "/tiles");
    if (!inside(rendition.tiles, rendition.width, rendition.height))
      in.fail(at, "/tiles", "must lie inside the picture");
  }
  rendition.barcode.rect = in.rect(at, "/barcode/rect");
  rendition.barcode.cell_size = int(in.integer(at, "/barcode/cellSize", 2, 64));
  if (!inside(rendition.barcode.rect, rendition.width, rendition.height) ||
      rendition.barcode.rect.width != 32 * rendition.barcode.cell_size) {
    in.fail(at, "/barcode", "must be 32 cells wide and inside the picture");
  }
}

void readLayout(FieldReader& in, const std::string& at, Sequence& s) {
  in.arraySize(at, "/layout", 2, 2);
  s.layout_width = int(in.integer(at, "/layout/0", 1, kMaxLayoutSide));
  s.layout_height = int(in.integer(at, "/layout/1", 1, kMaxLayoutSide));
}

void readBody(FieldReader& in, const std::string& at, Character& c) {
  const bool from_cameras = c.appearance == AppearanceKind::Cameras;
  c.name = in.text(at, "/name", 128);
  if (from_cameras && in.text(at, "/appearance", 64) != "cameras")
    in.fail(at, "/appearance", "must be \"cameras\" in this version");
  c.vertex_count = uint32_t(in.integer(at, "/vertexCount", 3, kMaxCount));
  c.face_count = uint32_t(in.integer(at, "/faceCount", 1, kMaxCount));
  if (from_cameras && in.has(at, "/method")) readMethod(in, at + "/method", c.method);
  c.bounds = readBox(in, at + "/bounds");
  c.ground_y_m = in.number(at, "/groundY", -kMaxMetres, kMaxMetres);
  if (in.has(at, "/lengthScale")) c.length_scale = in.number(at, "/lengthScale", 1e-6, 1e6);
  const int cameras = in.arraySize(at, "/cameras", 1, kMaxCameras);
  for (int k = 0; k < cameras; ++k) c.cameras.push_back(readCamera(in, item(at + "/cameras", k)));
}

const Sequence* Character::find(const std::string& sequence_name) const {
  for (const Sequence& s : sequences) {
    if (s.name == sequence_name) return &s;
  }
  return nullptr;
}

Result<Character> readManifest(const FlatJson& gltf) {
  const std::string at = std::string("/extensions/") + kExtensionName;
  if (gltf.string("/asset/version").value_or("") != "2.0") return invalidManifest("is not glTF 2.0");
  if (!gltf.has(at))
    return invalidManifest(std::string("has no extension ") + kExtensionName + ": not a fourdvt character");
  FieldReader in(gltf);
  Character character;
  character.version = int(in.integer(at, "/version", 1, 1 << 20));
  if (character.version == kLiveFormatVersion)
    return Error{ErrorId::Unsupported, "character.gltf: is of a live stream, which comes over WebSocket (ws://)"};
  if (in.ok() && character.version > kCoarseFormatVersion) {
    return Error{ErrorId::Unsupported, "character.gltf: format version " + std::to_string(character.version) +
                                           " is newer than this player; update the player"};
  }
  if (in.ok()) readCharacter(in, at, character);
  if (!in.ok()) return invalidManifest(in.problem());
  return character;
}

}  // namespace fourdvt::package
