// SPDX-License-Identifier: Apache-2.0
// Reads a capture folder: capture.json, COLMAP cameras, videos or image sequences, mattes, mesh sequences. Meshes
// have one topology in all frames, or another one in every frame ("topology": "per-frame"), or there are none.
//
// mattes::openCapture checks everything that can be checked without decoding whole videos, before any long work starts;
// mattes::FrameReader then reads frames. Keying is in native/mattes. Errors name the file and the remedy.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/camera.h"
#include "base/ground_motion.h"
#include "base/image.h"
#include "base/mesh.h"
#include "base/result.h"
#include "base/video.h"
#include "capture/surface_offsets.h"

namespace fourdvt::capture {

// Lens distortion in OpenCV's formulas, and skew. All zero and no fisheye: the camera is a pinhole already.
// With normalised x = X/Z, y = Y/Z and r² = x² + y² the lens images a point at
//   x' = x (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶) + 2 p1 x y + p2 (r² + 2 x²), y' alike, or,
//   fisheye, with (u, v) = (x, y) θ / r and θ = atan r, x' = u (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) + 2 p1 u v +
//   p2 (θ² + 2 u²) + sx1 θ², y' alike (COLMAP's THIN_PRISM_FISHEYE; OpenCV's where p and s are 0), or,
//   fov, (x', y') = (x, y) atan(2 r tan(fov / 2)) / (r fov) (COLMAP's FOV), the others 0;
// which is pixel (fx x' + skew y' + cx, fy y' + cy).
struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0, k5 = 0, k6 = 0;
  double skew = 0;  // pixels
  bool fisheye = false;
  double sx1 = 0, sy1 = 0;  // thin prism, of a fisheye
  double fov = 0;           // radians
  bool any() const {
    return fisheye || fov != 0 || k1 != 0 || k2 != 0 || p1 != 0 || p2 != 0 || k3 != 0 || k4 != 0 || k5 != 0 ||
           k6 != 0 || skew != 0;
  }
};

// Mattes required (or plates to make them from), or colour alone.
enum class MatteNeed { Required, None };

// Orientation of the pictures that a camera is calibrated for, where files mark theirs as rotated or mirrored.
enum class Orientation {
  BySize,  // the orientation with the calibrated size; an error if both have it
  Marked,  // the orientation that players show
  Stored,  // the orientation stored in the file
};

struct CaptureCamera {
  PinholeCamera pinhole;  // after undistortion; name as in images.txt without extension
  Distortion distortion;  // lens distortion, removed by the reader
  Orientation orientation = Orientation::BySize;
};

// Kind of a capture's meshes, equal in all sequences.
enum class CaptureMeshes {
  ConstantTopology,  // one mesh with UVs that moves
  PerFrame,          // vertices and faces of their own in every frame; UVs are not read
  None,
};

// Meshes that a caller requires.
enum class MeshNeed {
  ConstantTopology,  // refuses the others, with a remedy
  AnySurface,        // refuses captures without meshes
  Nothing,           // accepts all and reads none: the opened capture has no meshes, and broken files do no harm
};

// Sound recorded with a sequence, or a single sound.
struct CaptureSound {
  std::string path;     // absolute: a sound file, or a video with sound
  double offset_s = 0;  // delay of its beginning relative to picture 0; of a video: relative to its own picture 0
};

// Way of a performer through the room while a sequence plays, at a constant rate.
struct CaptureTravel {
  GroundMotion motion;    // from frame 0 to the frame after the last one
  glm::dvec2 place_m{0};  // place of the performer half way, along x and z
};

struct CaptureSequence {
  std::string name;
  uint32_t frame_count = 0;
  bool loop = false;
  glm::dvec3 root_velocity_mps{0};  // over the ground, of positions in place
  // Motion in the room, which pictures and meshes have and players do not show; a loop closes up to it.
  std::optional<CaptureTravel> travel;
  std::string folder;  // absolute
  // Meshes are one file per frame, one animated glTF file, or one packed int16 file with a declared scale; or none.
  std::string mesh_pattern;      // absolute, with one %d or %0Nd (none for a single file); empty if packed
  uint32_t first_mesh = 0;       // added to first_frame + f: number in the file name of frame f
  std::string packed_positions;  // absolute path or empty
  double packed_units_per_metre = 0;
  std::vector<uint32_t> test_frames;  // held-out frames, may be empty
  // Number of frame 0 in pictures, mesh files and held-out pictures; earlier ones are skipped.
  uint32_t first_frame = 0;
  // camera's name → offset: picture number first_frame + f + offset shows the instant of frame f. Missing cameras have
  // offset 0. Fractions are kept; the nearest picture is read.
  std::map<std::string, double> offset_frames;
  std::optional<CaptureSound> sound;
  double offsetOf(const std::string& camera) const;
  // Number of a camera's picture for a frame; a loop that does not travel wraps around to its first picture.
  uint32_t pictureOf(const std::string& camera, uint32_t frame) const;
};

// Parameter that a bake measures from the feet where members give no value: metres per second.
inline constexpr const char* kMeasuredParameter = "speed_mps";

// Motion class: captured motions with a common parameter, e.g. walk and run by speed ("classes" in capture.json).
struct CaptureClass {
  struct MemberOf {
    std::string sequence;
    std::vector<double> parameter;  // one value per parameter; empty: speed_mps, measured from the feet
  };
  std::string name;
  std::vector<std::string> parameters;   // 1 or 2 names, e.g. "speed_mps"
  std::vector<MemberOf> members;         // 2 to 4; all loops, or none
  std::optional<CaptureSound> footstep;  // one step, played at each footfall
};

inline constexpr const char* kHintsFolder = "hints";  // folder of a capture with hand-painted strokes for mattes

// Background behind the object for keying against plates of the empty studio.
enum class BackgroundKind {
  FromPlate,  // detected from each camera's plate: a saturated backdrop of one hue means a chroma key
  Chroma,     // a backdrop of one colour that is absent from the object
  Natural,    // any static background
};

struct Capture {
  std::string folder, name, credit;
  double fps = 0;
  double metres_per_unit = 1;
  double ground_y_m = 0;
  std::vector<CaptureCamera> cameras;  // images.txt order
  std::vector<CaptureSequence> sequences;
  std::vector<CaptureClass> classes;  // classes whose members are all in `sequences`
  std::string cameras_folder;         // contains cameras.txt and images.txt
  std::string background_folder;      // plates of the empty studio, for cameras without mattes
  BackgroundKind background_kind = BackgroundKind::FromPlate;
  std::optional<BoundingBox> room;  // metres; its inside is visible in the plates
  CaptureMeshes meshes = CaptureMeshes::ConstantTopology;
  MeshTopology topology;                          // constant over all sequences; empty without constant topology
  std::shared_ptr<const SurfaceOffsets> offsets;  // added to every mesh frame; null: none
  const CaptureSequence* find(const std::string& name) const;
};

// Reads the COLMAP model in `folder`: cameras.txt and images.txt, or else cameras.bin and images.bin. Models, all
// without skew: SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, OPENCV_FISHEYE,
// SIMPLE_RADIAL_FISHEYE, RADIAL_FISHEYE, THIN_PRISM_FISHEYE, FOV. Translations stay in the capture's units: scale them
// with scaleToMetres. Poses of rigs and frames override those of images; images become cameras as in camera_names.h.
// Errors: FileMissing, CameraModel, CameraPose.
Result<std::vector<CaptureCamera>> readColmapCameras(const std::string& folder);
// Reads the model from files in memory; messages name `path` as the folder.
Result<std::vector<CaptureCamera>> parseColmapText(std::string_view cameras_text, std::string_view images_text,
                                                   const std::string& path);
Result<std::vector<CaptureCamera>> parseColmapBinary(std::string_view cameras_bytes, std::string_view images_bytes,
                                                     const std::string& path);
void scaleToMetres(std::vector<CaptureCamera>& cameras, double metres_per_unit);
// Texts of cameras.txt and images.txt that readColmapCameras reads back, for cameras in metres. Skew is not part of
// COLMAP's models; it is stored in capture.json ("calibration": {"skew": …}).
struct ColmapText {
  std::string cameras, images;
};
ColmapText colmapText(const std::vector<CaptureCamera>& cameras, double metres_per_unit);

// Held-out cameras, folder cameras_test: they have test pictures and are excluded from bakes. In metres. Errors: those
// of readColmapCameras.
Result<std::vector<PinholeCamera>> readTestCameras(const Capture& capture);

// Opens a capture except its pictures: see mattes/frame_reader.h. `only` limits the sequences that are checked and
// returned (empty: all). Meshes of per-frame topology: checks that every file exists, and reads the first. Errors if
// `need` is not met: FileMissing (no meshes), MeshTopology.
Result<Capture> openDescription(const std::string& folder, const std::vector<std::string>& only, MeshNeed need);

// Positions of one frame of a capture of constant topology, with the capture's offsets. Errors: FileMissing,
// MeshTopology (names the file, or the capture has no constant topology), MeshNotFinite, MeshIndex.
Result<Positions> readMeshFrame(const Capture& capture, const CaptureSequence& sequence, uint32_t frame);

// The same as players show it: without the sequence's travel, in the heading that it has half way, and with the place
// that it has there at the origin. Pictures do not fit these positions.
Result<Positions> readMeshFrameInPlace(const Capture& capture, const CaptureSequence& sequence, uint32_t frame);
// Moves positions of a frame, as readMeshFrame returns them, to these.
void putInPlace(const CaptureSequence& sequence, uint32_t frame, Positions& positions);

// Surface of one frame, for any kind of meshes. Errors: those of readMeshFrame and readMeshFile (mesh_file.h);
// FileMissing without meshes.
Result<TriangleMesh> readSurfaceFrame(const Capture& capture, const CaptureSequence& sequence, uint32_t frame);

struct UvMesh {
  MeshTopology topology;
  Positions positions;
};
// Parses OBJ text: splits polygons into triangles (polygon.h) and flips the UVs to a top-left origin. `path` is for
// messages. `split_as`: the mesh at another instant, whose triangulation is reused; null: polygons are split by their
// own shape. Errors: MeshNoUvs, MeshNotFinite, MeshIndex, MeshUvRange, Unsupported (a face with too many corners).
Result<UvMesh> parseObj(std::string_view text, const std::string& path, const MeshTopology* split_as = nullptr);

}  // namespace fourdvt::capture
