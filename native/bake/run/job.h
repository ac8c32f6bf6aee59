// SPDX-License-Identifier: Apache-2.0
// The resolved plan of one bake: options, capture, mesh order, streams. validate creates it, refineJob corrects
// meshes and cameras, and planStreams completes it; after that only the align stage adds its measurements.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bake/motion/class_plan.h"
#include "bake/run/options.h"
#include "capture/capture.h"
#include "encode/camera_layout.h"
#include "encode/encoder.h"
#include "encode/tile.h"
#include "package/base_mesh.h"

namespace fourdvt::bake {

constexpr uint32_t kInputWindow = 32;  // frames, Job::input_digests

// One encoding of a stream's tiled picture.
struct RenditionPlan {
  std::string suffix;         // in its file's name, before ".mp4"; empty: the highest
  encode::TileLayout layout;  // from cameras: without layers
  package::Rect tiles;        // from cameras: position of their layout in the picture
  encode::EncodeSettings encode;
  bool shrunk = false;  // smaller than the highest's picture
  int eighths = 8;      // from cameras: its sides over the highest's, times 8
};

// One sequence of the character: a captured sequence, or a class, whose members' layers are all in one picture.
struct StreamPlan {
  std::string name;
  // A captured sequence is a plan with one member, itself, at its own frames, without references and parameters.
  ClassPlan motion;
  encode::CameraLayout cameras;            // from cameras
  std::vector<RenditionPlan> renditions;   // the highest first, which alone is read by later stages
  std::vector<uint32_t> gop_first_frames;  // ascending, starts with 0
  float detail_correlation = 1;            // correlation of the aligned members' details; set by the align stage
  const encode::TileLayout& layout() const { return renditions[0].layout; }  // layout of the highest rendition
  const encode::EncodeSettings& encode() const { return renditions[0].encode; }
  bool isClass() const { return motion.members.size() > 1; }
  uint32_t frameCount() const { return motion.frame_count; }
  uint32_t gopEnd(size_t gop) const {
    return gop + 1 < gop_first_frames.size() ? gop_first_frames[gop + 1] : frameCount();
  }
  // The captured frame of the member whose pictures and labels represent this frame.
  uint32_t sourceFrame(size_t member, uint32_t frame) const;
};

struct Job {
  // Resolved: jobs > 0, sequences listed, the appearance, lengths, folders without a trailing slash.
  BakeOptions options;
  capture::Capture capture;  // its sequences are surveyed and labelled; streams borrow them
  std::vector<PinholeCamera> cameras;
  std::vector<StreamPlan> streams;               // in the manifest's order: the sequences, then the classes
  std::optional<refine::Refinement> refinement;  // applied to the capture and the cameras
  std::string refinement_path;                   // file that keeps it between bakes
  // Mesh whose decoded order of vertices and faces is used everywhere in the bake. From cameras: the first surface
  // alone, for glTF viewers.
  package::EncodedBaseMesh mesh;
  BoundingBox bounds;              // over all frames
  double length_scale = 0;         // lengthScale in base/mesh.h; 0: not measured yet
  encode::TileLayout layout;       // layout for one member
  encode::EncodeSettings encode;   // settings for a captured sequence
  uint32_t total_frames = 0;       // number of captured frames
  std::vector<std::string> notes;  // notes on the plan for the user
  // [sequence][frame][camera], from cameras: region of the surface in each picture.
  std::vector<std::vector<std::vector<package::Rect>>> regions;
  // Set once the plan is complete: hash of the inputs of the work folder's files (settingsKey), by sequence the hash
  // of the inputs of visibility (captureKey), and the digests of the files of every kInputWindow frames
  // (capture/input_files.h).
  std::string settings_key;
  std::map<std::string, std::string> capture_keys;
  std::map<std::string, std::vector<uint64_t>> input_digests;
  std::map<std::string, uint64_t> mesh_digests;  // digest of all meshes of a sequence
  uint64_t common_input_digest = 0, sound_digest = 0;
  std::string writer;  // suffix of the names of result folders, where several processes may finish the same job
  bool fromCameras() const { return options.appearance == package::AppearanceKind::Cameras; }
  bool oneTopology() const {
    return capture.meshes == capture::CaptureMeshes::ConstantTopology;
  }                               // true if all meshes share one topology
  uint32_t streamFrames() const;  // number of frames of all streams
  // Beside the character folder and on its file system: finished GOPs, and the result until it is published.
  std::string workFolder() const { return options.character_folder + ".work"; }
  // Folder of visibility, colour maps, labels and the refinement.
  std::string surveyFolder() const {
    return options.survey_folder.empty() ? workFolder() + "/survey" : options.survey_folder;
  }
  std::string resultFolder() const { return workFolder() + "/result" + writer; }
  // The report until it is published beside the character.
  std::string reportFolder() const { return workFolder() + "/report" + writer; }
};

// Permutes `source` into the order of the decoded mesh.
Positions reordered(const package::EncodedBaseMesh& mesh, const Positions& source);

// Stores a planned job in a file, so that another process continues without reading the capture again. Leaves out the
// cameras' regions, from which the streams are planned, the pictures of a refinement, and the lab's
// rules for labels and texels. Errors: WriteFailed.
Status saveJob(const std::string& path, const Job& job);
// Errors: those of store::load.
Result<Job> loadJob(const std::string& path);

// Keys of files that are kept between bakes (job_keys.cpp): hashes of the files and settings that they depend on.

// Key of a sequence's inputs: its folder, meshes, cameras and plates (path, size, time), wherever capture.json places
// them; the meshes' topology, and capture.json.
std::string filesKey(const capture::Capture& capture, const capture::CaptureSequence& sequence);
// Hash of the inputs of visibility: those files, the mesh's order, the refinement. Reads no file after settleKeys.
std::string captureKey(const Job& job, const capture::CaptureSequence& sequence);
// Key of the labels' inputs beyond captureKey's.
std::string labelKey(const BakeOptions& options);

// Hash of all inputs of finished GOPs: options, capture files (path, size, time), the bake's version.
std::string settingsKey(const Job& job);

// Sets the job's keys and digests; once, after its streams are planned.
void settleKeys(Job& job);

}  // namespace fourdvt::bake
