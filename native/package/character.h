// SPDX-License-Identifier: Apache-2.0
// Validated manifest of a character folder (glTF extension FOURDVT_layered_video_texture). Reads no files and parses no
// JSON (base/flat_json.h). Layouts: FORMAT.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/camera.h"
#include "base/flat_json.h"
#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::package {

constexpr const char* kExtensionName = "FOURDVT_layered_video_texture";
constexpr int kFormatVersion = 1;        // layered character
constexpr int kCameraFormatVersion = 2;  // character from cameras
constexpr int kCoarseFormatVersion = 3;  // layered character, coarse geometry allowed
constexpr int kLiveFormatVersion = 4;    // live stream from cameras (live_stream.h)
constexpr int kMaxLayers = 6;
constexpr int kMaxCameras = 31;  // a face's camera set is a 32-bit mask
constexpr int kMaxPictureSide = 4096;
constexpr int kMaxLayoutSide = 8192;
constexpr uint8_t kNoCamera = 255;  // label of a rank without a camera
constexpr int kMaxMembers = 4;      // motions per class
constexpr int kMaxReferences = 32;  // mesh-blend corrections per class
constexpr int kMaxParameters = 2;

// Source of a character's surface texture. Layers: pictures in the UV space of a mesh of constant topology, baked from
// the labels' cameras. Cameras: the cameras' own pictures, selected and blended during playback; the topology may
// change every frame.
enum class AppearanceKind { Layers, Cameras };

struct Rect {
  int x = 0, y = 0, width = 0, height = 0;  // texels of the tiled picture, origin top left
};

// Frame index as 16 luma cells, repeated side by side. Layout: package/barcode.h.
struct BarcodeStrip {
  Rect rect;           // 2*16 cells wide
  int cell_size = 16;  // texels
};

struct Rendition {
  std::string video_uri;      // relative to the manifest
  uint64_t video_bytes = 0;   // file length
  std::string codec;          // RFC 6381, e.g. "avc1.640028"
  int width = 0, height = 0;  // tiled picture, even
  std::vector<Rect> layers;   // [member][layer], squares; a plain sequence has one member; empty for one from cameras
  BarcodeStrip barcode;
  Rect tiles;  // character from cameras: the sequence's layout, scaled
};

// One motion of a class, time-warped to the class's common phase. The member of a plain sequence is the sequence
// itself.
struct Member {
  std::string name;               // name of the captured sequence
  std::vector<double> parameter;  // point in parameter space; empty for a plain sequence
  double duration_s = 0;          // one full pass at weight 1
  glm::dvec3 travel{0};           // one full pass: metres along x and z, radians about y; character frame at its start
};

// Parameter values → weights, piecewise linear over simplices (algorithms/motion.md): find the simplex around a point
// and mix its corners. Samples are dense enough for a parameter value to match the resulting motion ("2.1 m/s").
struct ParameterSample {
  std::vector<double> at;      // one value per parameter
  std::vector<float> weights;  // one per member, sum 1
  std::vector<float> offsets;  // one per reference: coefficients of the mesh-blend corrections
};
struct ParameterSpace {
  std::vector<std::string> names;  // 1 or 2, e.g. "speed_mps"; empty: a plain sequence
  std::vector<ParameterSample> samples;
  std::vector<std::array<uint16_t, 3>> simplices;  // sample indices; with one parameter the last two are equal
};

// Plain sequence, or class: time-aligned motions tiled into one video for a single decoder. A class's frame_count
// counts common phases; its fps is that of the mean duration (Member::duration_s).
struct Sequence {
  std::string name;
  uint32_t frame_count = 0;
  double fps = 0;
  bool loop = false;
  glm::dvec3 root_velocity_mps{0};
  std::string stream_uri;  // .bin
  uint64_t stream_bytes = 0;
  uint32_t stream_header_bytes = 0;   // header + index: first range to fetch
  uint64_t stream_header_hash = 0;    // hash of the stream's header, which contains all other hashes (base/hash.h)
  std::vector<Rendition> renditions;  // ascending bitrate
  // Number of low renditions that pair with the stream's coarse chunks, and the byte length of those chunks.
  uint32_t coarse_renditions = 0;
  uint64_t coarse_bytes = 0;
  std::vector<Member> members;  // 1…kMaxMembers; exactly 1 for a plain sequence
  ParameterSpace space;
  uint32_t reference_count = 0;  // mesh-blend corrections per frame
  // Correlation of the aligned members' detail, 0..1: contrast that survives their blend; 1: all.
  float detail_correlation = 1;
  int layout_width = 0, layout_height = 0;  // character from cameras: texels of the tile layout
  bool isClass() const { return members.size() > 1; }
  double duration_s() const { return frame_count / fps; }
  bool hasCoarseGeometry(uint32_t rendition) const { return rendition < coarse_renditions; }
  // Bytes streamed beside a rendition's video: header and matching chunks.
  uint64_t geometryBytes(uint32_t rendition) const {
    return hasCoarseGeometry(rendition) ? stream_header_bytes + coarse_bytes : stream_bytes - coarse_bytes;
  }
};

// Capture room as a box seen from inside, and one picture of its faces.
struct Room {
  BoundingBox box;          // metres, camera world
  std::string picture_uri;  // PNG or JPEG; empty: no room
  uint64_t picture_bytes = 0, picture_hash = 0;
  int width = 0, height = 0;  // picture size
  std::array<Rect, 6> faces;  // rectangles in the picture, in the order of roomPoint
};

// Start file: base mesh, and frame 0 of the first sequence in its lowest rendition (start_file.h).
struct Start {
  std::string uri;  // empty: none
  uint64_t bytes = 0, hash = 0;
};

// Default drawing method of a character from cameras; a page or command may set another. Unknown methods fall back to
// the player's default.
struct DrawingMethod {
  std::string name;         // empty: player's default
  double sweep_band_m = 0;  // method "sweep": depth behind a performer's surface; 0: player's default
};

struct Character {
  std::string name;
  int version = kFormatVersion;
  AppearanceKind appearance = AppearanceKind::Layers;
  int layer_count = 0;                        // 0: character from cameras
  uint32_t vertex_count = 0, face_count = 0;  // decoded base mesh; from cameras: maximum over all frames
  std::vector<PinholeCamera> cameras;         // label k is cameras[k], and so is tile k
  BoundingBox bounds;                         // all frames of all sequences
  double ground_y_m = 0;
  // Factor of all lengths in drawing: the scene's size relative to one with a life-size performer.
  double length_scale = 1;
  std::string mesh_uri;  // file of the Draco base mesh; from cameras: first surface, unused by players
  uint64_t mesh_offset = 0, mesh_bytes = 0;
  uint64_t mesh_hash = 0;  // hash of the mesh bytes (base/hash.h)
  std::string poster_uri;
  std::string graph_uri;  // motion graph (motion/motion_graph.h); empty: none
  uint64_t graph_bytes = 0, graph_hash = 0;
  Room room;
  DrawingMethod method;  // character from cameras only
  std::vector<Sequence> sequences;
  Start start;

  const Sequence* find(const std::string& sequence_name) const;
};

// Validates all values that later stages index or allocate by. Errors: ManifestInvalid, Unsupported (newer, or live).
Result<Character> readManifest(const FlatJson& gltf);

// Point of the box that a room picture's face shows. Face order: -x, +x, -y (floor), +y (ceiling), -z, +z, each seen
// from inside: up is +y on walls, -z on floor and ceiling. `u` to the right and `v` down, both 0…1 over the face.
inline glm::vec3 roomPoint(const BoundingBox& box, int face, float u, float v) {
  const int axis = face / 2;
  const bool high = face % 2 == 1, mirrored = high == (axis != 0);
  glm::vec3 share;
  share[axis] = high ? 1.0f : 0.0f;
  share[axis == 0 ? 2 : 0] = mirrored ? 1 - u : u;
  share[axis == 1 ? 2 : 1] = axis == 1 ? v : 1 - v;
  return box.min + share * (box.max - box.min);
}

}  // namespace fourdvt::package
