// SPDX-License-Identifier: Apache-2.0
// A character folder as the player sees it: the manifest (glTF extension FOURDVT_layered_video_texture), validated.
// Does NOT read files and does NOT parse JSON (see base/flat_json.h). Layouts: FORMAT.md.
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
constexpr int kFormatVersion = 1;        // of a character from layers
constexpr int kCameraFormatVersion = 2;  // of a character from cameras
constexpr int kCoarseFormatVersion = 3;  // of a character from layers whose sequences may have coarse geometry
constexpr int kLiveFormatVersion = 4;    // of a live stream from cameras (live_manifest.h)
constexpr int kMaxLayers = 6;
constexpr int kMaxCameras = 31;  // a face's camera set is a 32-bit mask
constexpr int kMaxPictureSide = 4096;
constexpr int kMaxLayoutSide = 8192;
constexpr uint8_t kNoCamera = 255;  // label: no camera at this rank
constexpr int kMaxMembers = 4;      // motions of a class
constexpr int kMaxReferences = 32;  // corrections of a class's mesh blend
constexpr int kMaxParameters = 2;

// What a character's surface is textured from. Layers: pictures in the UV space of a mesh of constant topology, baked
// from the cameras that the labels name. Cameras: the cameras' own pictures, chosen and blended while it plays; every
// frame may have another topology.
enum class AppearanceKind { Layers, Cameras };

struct Rect {
  int x = 0, y = 0, width = 0, height = 0;  // texels of the tiled picture, origin top left
};

// 16 cells of luma (black/white), most significant first: 12-bit Gray code of the frame index, 4-bit CRC; the row of
// cells appears twice, side by side. See package/barcode.h.
struct BarcodeStrip {
  Rect rect;           // 2*16 cells wide
  int cell_size = 16;  // texels
};

struct Rendition {
  std::string video_uri;      // relative to the manifest
  uint64_t video_bytes = 0;   // length of the file
  std::string codec;          // RFC 6381, e.g. "avc1.640028"
  int width = 0, height = 0;  // tiled picture, even
  std::vector<Rect> layers;   // [member][layer], squares; a plain sequence has one member; empty: from cameras
  BarcodeStrip barcode;
  Rect tiles;  // from cameras: where the sequence's layout lies, scaled
};

// One motion of a class, warped to the class's common time. The member of a plain sequence is the sequence itself.
struct Member {
  std::string name;               // of the captured sequence
  std::vector<double> parameter;  // its place in parameter space; empty for a plain sequence
  double duration_s = 0;          // of one whole pass when this member has all the weight
  glm::dvec3 travel{0};  // of one whole pass: metres along x and z, radians about y; character frame at its start
};

// Parameter values → weights, piecewise linear over simplices (algorithms/motion.md): look up the simplex that holds
// the wanted point and mix its corners. The samples are dense enough that "2.1 m/s" means that speed.
struct ParameterSample {
  std::vector<double> at;      // one value per parameter
  std::vector<float> weights;  // one per member, sum 1
  std::vector<float> offsets;  // one per reference: coefficients of the mesh blend's corrections
};
struct ParameterSpace {
  std::vector<std::string> names;  // none: a plain sequence; else 1 or 2, e.g. "speed_mps"
  std::vector<ParameterSample> samples;
  std::vector<std::array<uint16_t, 3>> simplices;  // sample indices; with one parameter the last two are equal
};

// A plain sequence, or a class: motions aligned in time whose pictures are tiled into one video, so that one decoder
// serves them all. frame_count then counts common phases; fps is that of the mean duration, see Member::duration_s.
struct Sequence {
  std::string name;
  uint32_t frame_count = 0;
  double fps = 0;
  bool loop = false;
  glm::dvec3 root_velocity_mps{0};
  std::string stream_uri;  // .bin
  uint64_t stream_bytes = 0;
  uint32_t stream_header_bytes = 0;   // header + index: fetch this much first
  uint64_t stream_header_hash = 0;    // of these bytes, which hold the hashes of all others (base/hash.h)
  std::vector<Rendition> renditions;  // lowest bitrate first
  // So many of the lowest renditions go with the stream's coarse chunks, which have so many of its bytes.
  uint32_t coarse_renditions = 0;
  uint64_t coarse_bytes = 0;
  std::vector<Member> members;  // 1…kMaxMembers; exactly 1 for a plain sequence
  ParameterSpace space;
  uint32_t reference_count = 0;  // corrections of the mesh blend per frame
  // Correlation of the aligned members' detail, 0..1. It tells how much contrast their blend loses; 1: none.
  float detail_correlation = 1;
  int layout_width = 0, layout_height = 0;  // from cameras: texels of the layout that tiles are placed in
  bool isClass() const { return members.size() > 1; }
  double duration_s() const { return frame_count / fps; }
  bool hasCoarseGeometry(uint32_t rendition) const { return rendition < coarse_renditions; }
  // Bytes streamed beside a rendition's video: the header, and the chunks that go with it.
  uint64_t geometryBytes(uint32_t rendition) const {
    return hasCoarseGeometry(rendition) ? stream_header_bytes + coarse_bytes : stream_bytes - coarse_bytes;
  }
};

// The room that the performer was filmed in, as a box that is seen from inside, and one picture of its faces.
struct Room {
  BoundingBox box;          // metres, world of the cameras
  std::string picture_uri;  // PNG or JPEG; empty: there is no room
  uint64_t picture_bytes = 0, picture_hash = 0;
  int width = 0, height = 0;  // of the picture
  std::array<Rect, 6> faces;  // in the picture, in the order of roomPoint (package/room_faces.h)
};

// The first picture's own file: base mesh, and frame 0 of the first sequence in its lowest rendition (start_file.h).
struct Start {
  std::string uri;  // empty: there is none
  uint64_t bytes = 0, hash = 0;
};

// Method that a character from cameras is drawn by unless the page or the command sets another. A player that does not
// know the method takes its own default.
struct DrawingMethod {
  std::string name;         // empty: the player's default
  double sweep_band_m = 0;  // of the method "sweep", behind the surface of a person; 0: the player's default
};

struct Character {
  std::string name;
  int version = kFormatVersion;
  AppearanceKind appearance = AppearanceKind::Layers;
  int layer_count = 0;                        // from cameras: 0
  uint32_t vertex_count = 0, face_count = 0;  // of the decoded base mesh; from cameras: the most that any frame has
  std::vector<PinholeCamera> cameras;         // label k is cameras[k], and so is tile k
  BoundingBox bounds;                         // over all frames of all sequences
  double ground_y_m = 0;
  // Metres per metre of a scene in which the performer has a person's size: lengths of drawing are multiplied by it.
  double length_scale = 1;
  std::string mesh_uri;  // file that holds the Draco base mesh; from cameras: the first surface, which no player needs
  uint64_t mesh_offset = 0, mesh_bytes = 0;
  uint64_t mesh_hash = 0;  // of these bytes (base/hash.h)
  std::string poster_uri;
  std::string graph_uri;  // motion graph (motion/motion_graph.h); empty: none
  uint64_t graph_bytes = 0, graph_hash = 0;
  Room room;
  DrawingMethod method;  // from cameras
  std::vector<Sequence> sequences;
  Start start;

  const Sequence* find(const std::string& sequence_name) const;
};

// Validates everything that later stages index or allocate by. Errors: ManifestInvalid, Unsupported (newer, or live).
Result<Character> readManifest(const FlatJson& gltf);

}  // namespace fourdvt::package
