// SPDX-License-Identifier: Apache-2.0
// Sequences found by an import: the pictures of each camera, their count, size and rate.
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

// Removes cameras without pictures in one of the takes, with a warning for each; warns of videos without a camera.
// Errors: CameraMissingVideo (none is left).
Status keepSeenCameras(const std::vector<Take>& takes, ImportedCalibration& calibration,
                       std::vector<std::string>& warnings);

struct ViewMeasures {
  bool cropped =
      false;       // smaller pictures lack columns at the right and rows at the bottom; the camera gets their size
  double fps = 0;  // 0: rate of the first video that has one
  Orientation orientation = Orientation::BySize;
  bool time_codes = true;  // videos are aligned by time codes if all have one
};

// Opens every view once, reads its first and last picture and pairs the pictures (pairing.h): sets the take's frames,
// measures.fps, and sizes missing in the calibration. Errors: FrameSize, FileUnreadable, VideoTooShort, those of
// `open_video`.
Status measureViews(const OpenVideo& open_video, ImportedCalibration& calibration, Take& take, ViewMeasures& measures,
                    ClipNotes& notes);

// Sets take.alphas from the pictures linked in `folder`, the sequence's. Errors: those of matteOrigin.
Status findAlphas(const ImportedCalibration& calibration, const std::string& folder, const OpenVideo& open_video,
                  Take& take);

// Calls calibratedMarks; errors also name the options of an import.
Result<PictureMarks> importedMarks(const Image& stored, const PictureMarks& marks, const CaptureCamera& camera,
                                   const std::string& path);

}  // namespace fourdvt::capture
