// SPDX-License-Identifier: Apache-2.0
// Sequences of an import: the pictures of each camera, their count, size and rate; their frames (pairing.cpp), meshes
// (meshes.cpp) and files (layout.cpp).
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/video.h"
#include "capture/import/imported.h"
#include "capture/import/instants.h"
#include "capture/import/views.h"

namespace fourdvt::capture {

struct Take {
  std::string name, folder;
  std::map<std::string, View> views;   // by camera name
  std::map<std::string, View> mattes;  // cameras with mattes
  std::set<std::string> alphas;        // cameras whose mattes are the pictures' alpha
  std::vector<std::string> meshes;     // one file per frame, a single animated file for all frames, or empty
  bool loop = false;                   // the last frame precedes the first
  uint32_t frames = 0;                 // frames common to all cameras
  uint32_t first_frame = 0;            // number of frame 0, see CaptureSequence::first_frame
  uint32_t skipped = 0;                // instants before frame 0, which meshes include
  std::map<std::string, int64_t> offset_frames;
  bool hasOneMesh() const { return meshes.size() > 1 && meshes.front() == meshes.back(); }
};

// Sets each take's views and mattes by the pictures that the calibration names, or else by the cameras' file names; of
// several candidates, keeps the existing one and names the camera by it.
void findViews(ImportedCalibration& calibration, std::vector<Take>& takes);

// Removes cameras that lack pictures in any take, with a warning for each; warns of videos without a camera. Errors:
// CameraMissingVideo (none is left).
Status keepSeenCameras(const std::vector<Take>& takes, ImportedCalibration& calibration,
                       std::vector<std::string>& warnings);

struct ViewMeasures {
  bool cropped =
      false;       // smaller pictures lack columns at the right and rows at the bottom; the camera gets their size
  double fps = 0;  // 0: rate of the first video that has one
  Orientation orientation = Orientation::BySize;
  bool time_codes = true;  // videos are aligned by time codes if all have one
};

// Opens every view once, reads its first and last picture and pairs the pictures (pairPictures): sets the take's
// frames, measures.fps, and sizes missing in the calibration. Errors: FrameSize, FileUnreadable, VideoTooShort, those
// of `open_video`.
Status measureViews(const OpenVideo& open_video, ImportedCalibration& calibration, Take& take, ViewMeasures& measures,
                    ClipNotes& notes);

// Sets take.alphas from the pictures linked in `folder`, the sequence's. Errors: those of matteOrigin.
Status findAlphas(const ImportedCalibration& calibration, const std::string& folder, const OpenVideo& open_video,
                  Take& take);

// Calls calibratedMarks; errors also name the options of an import.
Result<PictureMarks> importedMarks(const Image& stored, const PictureMarks& marks, const CaptureCamera& camera,
                                   const std::string& path);

// Pairs the pictures of a take's cameras by their instants: frames of the capture are the longest stretch of instants
// at which no camera lacks a picture or a matte. `clips`: the take's cameras, with instants; `mattes`: cameras with
// mattes. Sets frames, first_frame and offset_frames of the take, and removes pictures outside the frames from its
// views. Notes missing pictures, and the pictures dropped because of them. Errors: VideoTooShort (no instant common to
// all clips).
Status pairPictures(const std::vector<Clip>& clips, const std::vector<Clip>& mattes, Take& take, ClipNotes& notes);

enum class ImportedMeshes { None, ConstantTopology, PerFrame };

// Finds meshes beside the pictures of an import; they stay unturned and unscaled. Sets the meshes of the takes, one
// file per frame, from the folder `mesh` of each: .obj, .ply, .glb or .gltf, by the numbers in their names. Topology is
// constant if all are OBJ files whose faces and UVs are equal in the first and the last frame of all takes. Errors:
// FileMissing (a frame has none), InvalidArgument (several series of files).
Result<ImportedMeshes> findMeshes(std::vector<Take>& takes, std::vector<std::string>& done,
                                  std::vector<std::string>& warnings);

// Parts of an imported capture folder. Errors: WriteFailed, and those of pictures.

// Links pictures and mattes of the take's cameras, and its meshes, into `folder`/NAME.
Status linkTake(const ImportedCalibration& calibration, const Take& take, const std::string& folder);
// Writes background/CAMERA/000000.png …: links to the plates, or up to 25 pictures of the clip.
Status writePlates(const View& plates, const CaptureCamera& camera, const OpenVideo& open_video,
                   const std::string& folder);
// Writes cameras/cameras.txt, cameras/images.txt and capture.json; cameras are in metres, Y up.
Status writeDescription(const ImportedCalibration& calibration, const std::vector<Take>& takes, ImportedMeshes meshes,
                        const std::vector<CaptureClass>& classes, double fps, const std::string& folder);

}  // namespace fourdvt::capture
