// SPDX-License-Identifier: Apache-2.0
// The sequences that an import finds: which camera has which pictures, how many, how large and how fast.
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
  std::map<std::string, View> views;   // by camera's name
  std::map<std::string, View> mattes;  // of those that have some
  std::set<std::string> alphas;        // of those whose pictures' alpha is the matte
  std::vector<std::string> meshes;     // one file a frame, the same one for an animation of all, or none
  bool loop = false;                   // the frame after the last one is the first
  uint32_t frames = 0;                 // that all cameras have
  uint32_t first_frame = 0;            // as in capture.json
  uint32_t skipped = 0;                // instants of the clips before frame 0, which have meshes, too
  std::map<std::string, int64_t> offset_frames;
  bool hasOneMesh() const { return meshes.size() > 1 && meshes.front() == meshes.back(); }
};

// Sets each take's views and mattes by the pictures that the calibration names, or else by the names of the cameras'
// files; of several names, keeps the one that is there and names the camera by it.
void findViews(ImportedCalibration& calibration, std::vector<Take>& takes);

// Removes the cameras that have no pictures in one of the takes, with a warning for each; warns of videos without a
// camera. Errors: CameraMissingVideo (none is left).
Status keepSeenCameras(const std::vector<Take>& takes, ImportedCalibration& calibration,
                       std::vector<std::string>& warnings);

struct ViewMeasures {
  bool cropped =
      false;       // smaller pictures lack columns at the right and rows at the bottom: their size is the camera's
  double fps = 0;  // 0: that of the first video that has one
  Orientation orientation = Orientation::BySize;
  bool time_codes = true;  // videos begin by their time codes, if all have one
};

// Opens every view once, reads its first and its last picture and pairs their pictures (pairing.h): sets what frames
// the take has, measures.fps, and the sizes that the calibration does not give. Errors: FrameSize, FileUnreadable,
// VideoTooShort, those of `open_video`.
Status measureViews(const OpenVideo& open_video, ImportedCalibration& calibration, Take& take, ViewMeasures& measures,
                    ClipNotes& notes);

// Sets take.alphas from the pictures as they are linked in `folder`, the sequence's. Errors: those of matteOrigin.
Status findAlphas(const ImportedCalibration& calibration, const std::string& folder, const OpenVideo& open_video,
                  Take& take);

// The same as calibratedMarks; errors also name the options of an import.
Result<PictureMarks> importedMarks(const Image& stored, const PictureMarks& marks, const CaptureCamera& camera,
                                   const std::string& path);

}  // namespace fourdvt::capture
