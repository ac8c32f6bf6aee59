// SPDX-License-Identifier: Apache-2.0
// Frames of one sequence: from pictures to files in the frame store. A sequence is divided into windows. Surfaces
// depend on earlier frames of their window, by stereo's temporal averaging, and on the sequence's first frame, whose
// figures hold the scale of all. After the first frame, windows can be computed in any order by any process.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "capture/capture.h"
#include "capture/folder/result_folder.h"
#include "mattes/frame_reader.h"
#include "reconstruct/run/frame_figures.h"
#include "reconstruct/run/frame_surface.h"
#include "reconstruct/run/prepare.h"

namespace fourdvt::reconstruct {
// Settings that determine frames: options, calibration, and names, sizes and times of pictures, mattes and plates.
std::string settingsKey(const ReconstructOptions& options, const capture::Capture& capture);

// Store of the finished frames of a reconstruction, in the folders described in result_folder.h. Files are written
// atomically; a frame is finished once its figures are stored.
class FrameStore {
 public:
  // `key`: the folder's settings. Frames of other settings are not found, and saving fails if the folder's settings
  // have changed.
  FrameStore(const capture::ResultFolder& folder, const capture::Capture& capture, const std::string& key);

  Status makeFolders(const std::string& sequence) const;
  // Returns none if the frame is not finished.
  std::optional<FrameFigures> find(const std::string& sequence, uint32_t frame) const;
  // Errors: InvalidArgument if the folder now has other settings.
  Status checkFolder() const;
  // `mesh` is in metres, the file in the capture's unit. Errors: those of checkFolder; WriteFailed.
  Status save(const std::string& sequence, uint32_t frame, const TriangleMesh& mesh, const FrameFigures& figures) const;
  Result<TriangleMesh> loadMesh(const std::string& sequence, uint32_t frame) const;
  // Removes temporary files of killed processes beside the meshes of a finished sequence.
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

inline constexpr uint32_t kWindow = 32;  // frames per window

inline uint32_t windowsOf(const capture::CaptureSequence& sequence) {
  return (sequence.frame_count + kWindow - 1) / kWindow;
}
// End of a window's frames.
inline uint32_t windowEnd(const capture::CaptureSequence& sequence, uint32_t window) {
  return std::min((window + 1) * kWindow, sequence.frame_count);
}

class SequenceFrames {
 public:
  using Made = std::function<void(uint32_t frame, const mattes::CaptureFrame& captured, const FrameSurface& surface)>;

  // Borrows all arguments; the maker must not be used for another sequence meanwhile.
  SequenceFrames(const Prepared& job, const ReconstructEnvironment& environment, const FrameStore& store,
                 SurfaceMaker& maker, const capture::CaptureSequence& sequence)
      : job_(job), environment_(environment), store_(store), maker_(maker), sequence_(sequence) {}

  // Computes frame 0 unless it exists. Errors: those of makeWindow.
  Status makeFirst(const Made& made = {});
  // Computes the missing frames of a window, with stereo all of them; returns the number of existing frames kept.
  // Windows of one object must ascend. `made` is called after each saved frame. Errors: those of pictures;
  // NothingVisible and InvalidArgument (contradictory silhouettes), with sequence and frame; Internal (no first frame);
  // GpuFailure; WriteFailed; Interrupted.
  Result<uint32_t> makeWindow(uint32_t window, const Made& made = {});

 private:
  Status begin(uint32_t frame);
  Status make(uint32_t frame, const Made& made);
  Status checkAgreement(uint32_t frame, const std::vector<Image>& pictures);
  std::string nameOf(uint32_t frame) const {
    return job_.folderOf(sequence_.name) + ", frame " + std::to_string(frame) + ": ";
  }

  const Prepared& job_;
  const ReconstructEnvironment& environment_;
  const FrameStore& store_;
  SurfaceMaker& maker_;
  const capture::CaptureSequence& sequence_;
  std::unique_ptr<mattes::FrameReader> reader_;  // null before the first frame
  bool agreed_ = false;                          // consistency was checked in this window or in frame 0
};

}  // namespace fourdvt::reconstruct
