// SPDX-License-Identifier: Apache-2.0
// Frames of one sequence, from their pictures to files in the frame store. A sequence is cut into windows: surfaces
// depend on the frames before them in their window, where stereo keeps them steady, and on the sequence's first frame,
// whose figures hold the lengths that all are made with. So windows may be made in any order, by any process, once the
// first frame is there.
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
// The finished frames of a reconstruction, in the folders that result_folder.h describes. Files are written atomically;
// a frame is finished once its figures are there. Does NOT make surfaces.

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

inline constexpr uint32_t kWindow = 32;  // frames after which a surface no longer depends on those before

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

  // Borrows all of them. The maker serves no other sequence meanwhile.
  SequenceFrames(const Prepared& job, const ReconstructEnvironment& environment, const FrameStore& store,
                 SurfaceMaker& maker, const capture::CaptureSequence& sequence)
      : job_(job), environment_(environment), store_(store), maker_(maker), sequence_(sequence) {}

  // Makes frame 0, unless it is there. Errors: those of makeWindow.
  Status makeFirst(const Made& made = {});
  // Makes what is missing of a window, with stereo all of it; returns how many of its frames were kept. Windows of one
  // object go up. `made` is called after each frame that is saved. Errors: those of pictures; NothingVisible and
  // InvalidArgument (silhouettes that contradict each other), naming sequence and frame; Internal (no first frame);
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
  std::unique_ptr<mattes::FrameReader> reader_;  // null: no frame was made yet
  bool agreed_ = false;                          // silhouettes were judged, in this window or in frame 0
};

}  // namespace fourdvt::reconstruct
