// SPDX-License-Identifier: Apache-2.0
// Reads a capture folder: capture.json, COLMAP cameras, videos or image sequences, mattes, mesh sequences. Meshes
// have one topology in all frames, or another one in every frame ("topology": "per-frame"), or there are none.
//
// mattes::openCapture checks everything that can be checked without decoding whole videos, before any long work starts;
// mattes::FrameReader then reads frames. Does NOT key. Errors name the file and the remedy.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/camera.h"
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

// Need of a reader: mattes (or plates to make them from), or colour alone.
enum class MatteNeed { Required, None };

// Pictures that a camera is calibrated for, where files mark theirs as turned or mirrored.
enum class Orientation {
  BySize,  // those of the calibrated size; an error where both are
  Marked,  // as players show them
  Stored,  // as they lie in the file
};

struct CaptureCamera {
  PinholeCamera pinhole;  // after undistortion; name as in images.txt without extension
  Distortion distortion;  // what the reader removes
  Orientation orientation = Orientation::BySize;
};

// What surface a capture has, in all its sequences alike.
enum class CaptureMeshes {
  ConstantTopology,  // one mesh with UVs that moves
  PerFrame,          // every frame has vertices and faces of its own; UVs are not read
  None,
};

// Meshes that a caller can work with.
enum class MeshNeed {
  ConstantTopology,  // refuses the others, and says what helps
  AnySurface,        // refuses captures without meshes
  Nothing,           // accepts all, and looks at no mesh: what it opens has none, so that broken files do no harm
};

// Sound that was recorded with a sequence, or a single sound.
struct CaptureSound {
  std::string path;     // absolute: a sound file, or a video with sound
  double offset_s = 0;  // its beginning is heard so much later than picture 0 is seen; of a video: its own picture 0
};

struct CaptureSequence {
  std::string name;
  uint32_t frame_count = 0;
  bool loop = false;
  glm::dvec3 root_velocity_mps{0};
  std::string folder;  // absolute
  // Its meshes are one file a frame, one animated glTF file, or one packed int16 file with a declared scale; neither if
  // it has none.
  std::string mesh_pattern;      // absolute, one %d or %0Nd for the number; none where one file is all; empty if packed
  uint32_t first_mesh = 0;       // added to first_frame + f: number in the name of a frame's file
  std::string packed_positions;  // absolute path or empty
  double packed_units_per_metre = 0;
  std::vector<uint32_t> test_frames;  // held-out frames, may be empty
  // Frame 0 is this number of pictures, mesh files and held-out pictures: those before it are left out.
  uint32_t first_frame = 0;
  // By camera's name: picture number first_frame + f + offset shows the instant of frame f. Cameras that are not named
  // are on time. Fractions are kept, but the nearest picture is what is read.
  std::map<std::string, double> offset_frames;
  std::optional<CaptureSound> sound;
  double offsetOf(const std::string& camera) const;
  // Number of a camera's picture for a frame; a loop goes on with its first picture.
  uint32_t pictureOf(const std::string& camera, uint32_t frame) const;
};

// The parameter that a bake measures from the feet where members give no value: metres a second.
inline constexpr const char* kMeasuredParameter = "speed_mps";

// Captured motions that are one motion with a parameter, e.g. walk and run by speed ("classes" in capture.json).
struct CaptureClass {
  struct MemberOf {
    std::string sequence;
    std::vector<double> parameter;  // one value per parameter; empty: speed_mps, measured from the feet
  };
  std::string name;
  std::vector<std::string> parameters;   // 1 or 2 names, e.g. "speed_mps"
  std::vector<MemberOf> members;         // 2…4; all loops, or none
  std::optional<CaptureSound> footstep;  // one step, to be heard whenever a foot comes down
};

inline constexpr const char* kHintsFolder = "hints";  // of a capture: mattes' strokes painted by hand

// What stands behind the object where it is keyed against plates of the empty studio.
enum class BackgroundKind {
  FromPlate,  // told from each camera's plate: a saturated backdrop of one hue is a chroma key's
  Chroma,     // a backdrop of one colour that the object has not
  Natural,    // anything that stands still
};

struct Capture {
  std::string folder, name, credit;
  double fps = 0;
  double metres_per_unit = 1;
  double ground_y_m = 0;
  std::vector<CaptureCamera> cameras;  // ring, in images.txt order
  std::vector<CaptureSequence> sequences;
  std::vector<CaptureClass> classes;  // those whose members are all among `sequences`
  std::string cameras_folder;         // cameras.txt and images.txt
  std::string background_folder;      // plates of the empty studio, for cameras without mattes
  BackgroundKind background_kind = BackgroundKind::FromPlate;
  std::optional<BoundingBox> room;  // metres; the plates show its inside
  CaptureMeshes meshes = CaptureMeshes::ConstantTopology;
  MeshTopology topology;                          // constant over all sequences; empty without constant topology
  std::shared_ptr<const SurfaceOffsets> offsets;  // added to every mesh frame that is read; null: none
  const CaptureSequence* find(const std::string& name) const;
};

// Reads the COLMAP model in `folder`: cameras.txt and images.txt, or else cameras.bin and images.bin. Models:
// SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, OPENCV_FISHEYE, SIMPLE_RADIAL_FISHEYE,
// RADIAL_FISHEYE, THIN_PRISM_FISHEYE, FOV; none of them has skew. Translations stay in the capture's units: scale them
// with scaleToMetres. Poses of rigs and frames go before those of images; images are cameras as in camera_names.h.
// Errors: FileMissing, CameraModel, CameraPose.
Result<std::vector<CaptureCamera>> readColmapCameras(const std::string& folder);
// The same from files in memory; messages name `path` as the folder.
Result<std::vector<CaptureCamera>> parseColmapText(std::string_view cameras_text, std::string_view images_text,
                                                   const std::string& path);
Result<std::vector<CaptureCamera>> parseColmapBinary(std::string_view cameras_bytes, std::string_view images_bytes,
                                                     const std::string& path);
void scaleToMetres(std::vector<CaptureCamera>& cameras, double metres_per_unit);
// The texts of cameras.txt and images.txt for cameras in metres: what readColmapCameras reads. COLMAP has no word for
// skew: capture.json has ("calibration": {"skew": …}).
struct ColmapText {
  std::string cameras, images;
};
ColmapText colmapText(const std::vector<CaptureCamera>& cameras, double metres_per_unit);

// The held-out cameras, folder cameras_test: test pictures exist of them, and no bake sees them. In metres.
// Errors: those of readColmapCameras.
Result<std::vector<PinholeCamera>> readTestCameras(const Capture& capture);

// Everything but the pictures: see mattes/frame_reader.h. `only` limits the sequences that are checked and returned
// (empty: all). Of meshes of per-frame topology it checks that every file is there, and reads the first. Errors of a
// need that is not met: FileMissing (no meshes), MeshTopology.
Result<Capture> openDescription(const std::string& folder, const std::vector<std::string>& only, MeshNeed need);

// Positions of one frame of a capture of constant topology, with the capture's offsets. Errors: FileMissing,
// MeshTopology (file named, or the capture has no constant topology), MeshNotFinite, MeshIndex.
Result<Positions> readMeshFrame(const Capture& capture, const CaptureSequence& sequence, uint32_t frame);

// The surface of one frame, whatever meshes the capture has. Errors: those of readMeshFrame and readMeshFile
// (mesh_file.h); FileMissing if the capture has none.
Result<TriangleMesh> readSurfaceFrame(const Capture& capture, const CaptureSequence& sequence, uint32_t frame);

struct UvMesh {
  MeshTopology topology;
  Positions positions;
};
// Parses OBJ text: splits polygons into triangles (polygon.h) and flips the UVs to a top-left origin. `path` is for
// messages. `split_as`: the mesh at another instant, whose polygons are split in the same way; null: by their own
// shape. Errors: MeshNoUvs, MeshNotFinite, MeshIndex, MeshUvRange, Unsupported (a face of too many corners).
Result<UvMesh> parseObj(std::string_view text, const std::string& path, const MeshTopology* split_as = nullptr);

}  // namespace fourdvt::capture
