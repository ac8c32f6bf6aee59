// SPDX-License-Identifier: Apache-2.0
// The finished frames of a reconstruction, in the folders that result_folder.h describes. Files are written atomically;
// a frame is finished once its figures are there. Does NOT make surfaces.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "capture/capture.h"
#include "capture/folder/result_folder.h"
#include "reconstruct/run/frame_figures.h"
#include "reconstruct/run/options.h"

namespace fourdvt::reconstruct {

// What decides how frames come out: options, calibration, and names, sizes and times of pictures, mattes and plates.
std::string settingsKey(const ReconstructOptions& options, const capture::Capture& capture);

class FrameStore {
 public:
  // `key`: that of the folder's settings. Frames of other settings are not found, and nothing is saved into a folder
  // that has got others meanwhile.
  FrameStore(const capture::ResultFolder& folder, const capture::Capture& capture, const std::string& key);

  Status makeFolders(const std::string& sequence) const;
  // Nothing if the frame is not finished.
  std::optional<FrameFigures> find(const std::string& sequence, uint32_t frame) const;
  // Errors: InvalidArgument if the folder belongs to other settings now.
  Status checkFolder() const;
  // Meshes are in metres here and in the capture's unit in the file. Errors: those of checkFolder; WriteFailed.
  Status save(const std::string& sequence, uint32_t frame, const TriangleMesh& mesh, const FrameFigures& figures) const;
  Result<TriangleMesh> loadMesh(const std::string& sequence, uint32_t frame) const;
  // Removes what processes that were killed left beside the meshes of a finished sequence.
  void removeLeftovers(const std::string& sequence) const;

 private:
  std::string meshPath(const std::string& sequence, uint32_t frame) const;
  std::string figuresPath(const std::string& sequence, uint32_t frame) const;

  std::string figuresFolder(const std::string& sequence) const;

  capture::ResultFolder folder_;
  std::string key_;
  double metres_per_unit_;
  std::map<std::string, uint32_t> first_frames_;  // by sequence
};

}  // namespace fourdvt::reconstruct
