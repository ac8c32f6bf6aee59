// SPDX-License-Identifier: Apache-2.0
// Where a reconstruction keeps what it has finished until all is there, beside the folder that is to be written:
//   CAPTURE2.part   the capture folder that is being made
//   CAPTURE2.work   the settings it is made with, and the figures of finished frames
// Files are written atomically; a frame is finished once its figures are there. Does NOT make surfaces.
#pragma once

#include <optional>
#include <string>

#include "capture/capture.h"
#include "reconstruct/run/frame_figures.h"
#include "reconstruct/run/options.h"

namespace fourdvt::reconstruct {

// What decides how frames come out: options, calibration, and names, sizes and times of pictures, mattes and plates.
std::string settingsKey(const ReconstructOptions& options, const capture::Capture& capture);

// Absolute, without links. Errors: InvalidArgument if the target and the capture that is read lie in each other, or if
// the target holds something that is no reconstruction.
Result<std::string> checkedTarget(const ReconstructOptions& options);

class FrameStore {
 public:
  FrameStore(const std::string& target, double metres_per_unit) : target_(target), metres_per_unit_(metres_per_unit) {}
  std::string resultFolder() const { return target_ + ".part"; }

  // What an earlier run left stays only with `resume`. Errors: InvalidArgument (left with another key, or not left by
  // reconstruct), WriteFailed.
  Status open(const std::string& key, bool resume) const;
  Status makeFolders(const std::string& sequence) const;
  // Nothing if the frame is not finished.
  std::optional<FrameFigures> find(const std::string& sequence, uint32_t frame) const;
  // Meshes are in metres here and in the capture's unit in the file.
  Status save(const std::string& sequence, uint32_t frame, const TriangleMesh& mesh, const FrameFigures& figures) const;
  Result<TriangleMesh> loadMesh(const std::string& sequence, uint32_t frame) const;
  // The result takes the target's place. On failure all frames are still kept.
  Status finish() const;

 private:
  std::string workFolder() const { return target_ + ".work"; }
  std::string keyPath() const { return workFolder() + "/settings.txt"; }
  std::string meshPath(const std::string& sequence, uint32_t frame) const;
  std::string figuresPath(const std::string& sequence, uint32_t frame) const;

  std::string target_;
  double metres_per_unit_;
};

}  // namespace fourdvt::reconstruct
