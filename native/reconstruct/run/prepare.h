// SPDX-License-Identifier: Apache-2.0
// Serial part of a reconstruction, in one process before its frames: opens the capture, excludes cameras, links the new
// folder to the inputs, calibrates and synchronises cameras, and computes missing mattes.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/video.h"
#include "base/watch.h"
#include "capture/capture.h"
#include "capture/folder/result_folder.h"
#include "gpu/device.h"
#include "refine/run/calibrate_capture.h"

namespace fourdvt::reconstruct {
enum class HullKind { Polyhedral, Volumetric };

struct ReconstructOptions {
  std::string capture_folder, folder;  // input, output
  std::vector<std::string> sequences;  // empty: all
  std::vector<std::string> leave_out;  // cameras
  bool mattes_alone = false;           // computes missing mattes per camera, independently
  bool any_silhouettes = false;        // continues without a common volume of the silhouettes
  bool synchronise = true;             // estimates cameras' times from silhouettes
  bool refine_cameras = true;          // estimates cameras' poses from silhouettes
  HullKind hull = HullKind::Volumetric;
  double contour_tolerance_px = 1;  // polyhedral: maximum distance of a polygon from the outline, 0.25 to 8
  double voxel_m = 0;               // volumetric hull and stereo; 0: from the pixel footprint, see scale.h
  int faces = 150'000;              // maximum per surface, by simplification
  double adaptivity = 0.1;          // 0 … 1, see VolumetricOptions
  bool stereo = true;               // inside the volumetric hull only
  int planes = 64;                  // stereo: depths per pixel, a multiple of 4, 16 to 128
  int fairing = 0;                  // rounds of fairSurface (surface_cleaning.h)
  int jobs = 0;                     // threads; 0: one per core
  bool resume = false;
  // Error message in one line, or empty.
  std::string check() const;
};

struct ReconstructEnvironment {
  gpu::Device* device = nullptr;  // current on this thread; may be null without stereo
  OpenVideo open_video;
  std::function<void(const FrameProgress&)> progress;
  std::function<void(const std::string&)> note;  // receives one line of information; may be empty
  const std::atomic<bool>* stop = nullptr;       // set by Ctrl-C: ends after the current frame, keeping finished frames
};

// Limits the threads of OpenCV and OpenVDB during its lifetime; 0: no limit.
class Threads {
 public:
  explicit Threads(int count);
  ~Threads();

 private:
  struct Limit;
  std::unique_ptr<Limit> limit_;
};

// Prepared reconstruction without frames.
struct Prepared {
  ReconstructOptions options;         // options with absolute folders and named sequences
  std::string settings_key;           // one line: settings that determine the frames
  std::vector<std::string> warnings;  // one line each
  std::string name;                   // input capture
  capture::Capture capture;           // new folder, the source of all frames, with the input's name

  // Folder of a sequence in the input, for messages.
  std::string folderOf(const std::string& sequence) const { return options.capture_folder + "/" + sequence; }
};

capture::ResultFolder resultFolder(const ReconstructOptions& options);

using capture::Earlier;

class Preparation {
 public:
  // Borrows the environment.
  Preparation(const ReconstructOptions& options, const ReconstructEnvironment& environment)
      : environment_(environment), given_folder_(options.capture_folder) {
    out_.options = options;
  }

  // Prepares everything but mattes. Errors: those of openCapture; InvalidArgument (folders, names, work of other
  // settings); WriteFailed; Interrupted.
  Status link(Earlier earlier);
  // The new folder; valid after link().
  const capture::Capture& capture() const { return out_.capture; }
  bool wantsMattes() const { return wants_mattes_; }
  // Computes missing mattes from all cameras together; colour keys are evaluated as frames are read. Errors: those of
  // mattes::addMattes.
  Status addMattes();
  Prepared take() { return std::move(out_); }

 private:
  Status openGiven();
  Status linkFrames();
  Status calibrate();

  const ReconstructEnvironment& environment_;
  const std::string given_folder_;  // path given by the user
  Prepared out_;
  capture::Capture given_;  // input; its cameras and times are replaced by the calibrated ones
  bool wants_mattes_ = false;
  std::optional<refine::Calibration> calibration_;  // computed by this run
};

struct JobFile {
  Prepared job;                      // without its capture, of which a piece opens only its part
  uint64_t common_input_digest = 0;  // see capture/input_files.h, of the new folder
};

// Writes the state from which every piece continues: options, and results of planning. Errors: WriteFailed.
Status writeJobFile(const std::string& job_folder, const JobFile& file);
// Errors: FileMissing; FileUnreadable (damaged, or of another version).
Result<JobFile> readJobFile(const std::string& job_folder);

}  // namespace fourdvt::reconstruct
