// SPDX-License-Identifier: Apache-2.0
// The serial part of a reconstruction, before its frames: the capture is opened, cameras are left out, the new folder
// is linked to it, cameras are put in step and in place, mattes that are missing are made. One process does it, and
// every frame needs all of it. Does NOT make surfaces.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/video.h"
#include "capture/capture.h"
#include "capture/folder/result_folder.h"
#include "gpu/device.h"
#include "refine/run/calibrate_capture.h"

namespace fourdvt::reconstruct {
// What `fourdvt reconstruct` is asked for, and what it needs from the program that runs it.

enum class HullKind { Polyhedral, Volumetric };

struct ReconstructOptions {
  std::string capture_folder, folder;  // read, written
  std::vector<std::string> sequences;  // empty: all
  std::vector<std::string> leave_out;  // cameras
  bool mattes_alone = false;           // missing mattes: every camera by itself
  bool any_silhouettes = false;        // go on although no common volume explains the silhouettes
  bool synchronise = true;             // cameras, by their silhouettes
  bool refine_cameras = true;          // the same of their poses
  HullKind hull = HullKind::Volumetric;
  double contour_tolerance_px = 1;  // polyhedral: how far a polygon may be from the outline, 0.25 to 8
  double voxel_m = 0;               // volumetric hull and stereo; 0: by the pictures, see scale.h
  int faces = 150'000;              // the most of a surface; those beyond are simplified away
  double adaptivity = 0.1;          // 0 … 1, see VolumetricOptions
  bool stereo = true;               // inside the volumetric hull only
  int planes = 64;                  // of stereo: depths tried in its band, a multiple of 4, 16 to 128
  int fairing = 0;                  // rounds, see surface_cleaning.h
  int jobs = 0;                     // threads; 0: one per core
  bool resume = false;
  // Empty, or what is wrong with the options, in one line.
  std::string check() const;
};

struct ReconstructProgress {
  std::string stage;  // "run 12/28"
  uint32_t done = 0, total = 0;
  double frames_per_s = 0, left_s = 0;
};

struct ReconstructEnvironment {
  gpu::Device* device = nullptr;  // current on this thread; may be null without stereo
  OpenVideo open_video;
  std::function<void(const ReconstructProgress&)> progress;
  std::function<void(const std::string&)> note;  // a line for the person who plans; may be empty
  const std::atomic<bool>* stop = nullptr;       // set by Ctrl-C: finish the frame, keep what is finished
};

// Limit on the threads of OpenCV and OpenVDB while it lives; 0: none.
class Threads {
 public:
  explicit Threads(int count);
  ~Threads();

 private:
  struct Limit;
  std::unique_ptr<Limit> limit_;
};

// A reconstruction up to its frames.
struct Prepared {
  ReconstructOptions options;         // folders absolute, sequences named
  std::string settings_key;           // one line: what decides how frames come out
  std::vector<std::string> warnings;  // one line each
  std::string name;                   // of the capture that is read
  capture::Capture capture;           // the new folder, which frames are read from, under that name

  // The user's folder of a sequence, for messages.
  std::string folderOf(const std::string& sequence) const { return options.capture_folder + "/" + sequence; }
};

capture::ResultFolder resultFolder(const ReconstructOptions& options);

// Work that an earlier run left in the same place.
enum class Earlier {
  Removed,
  Kept,       // or refused, if it is of other settings
  KeptIfSame  // removed with a note, if it is of other settings
};

class Preparation {
 public:
  // Borrows the environment.
  Preparation(const ReconstructOptions& options, const ReconstructEnvironment& environment)
      : environment_(environment), given_folder_(options.capture_folder) {
    out_.options = options;
  }

  // Everything but mattes. Errors: those of openCapture; InvalidArgument (folders, names, work of other settings);
  // WriteFailed; Interrupted.
  Status link(Earlier earlier);
  // The new folder, once it is linked.
  const capture::Capture& capture() const { return out_.capture; }
  bool wantsMattes() const { return wants_mattes_; }
  // Makes the mattes that are missing, cameras together; colour keys are made as frames are read. Errors: those of
  // mattes::addMattes.
  Status addMattes();
  Prepared take() { return std::move(out_); }

 private:
  Status openGiven();
  Status linkFrames();
  Status calibrate();

  const ReconstructEnvironment& environment_;
  const std::string given_folder_;  // as the user calls it
  Prepared out_;
  capture::Capture given_;  // later with the new one's cameras and times
  bool wants_mattes_ = false;
  std::optional<refine::Calibration> calibration_;  // made by this run
};

// The file of a job folder from which every piece of a reconstruction goes on: options, and what planning found out.

struct JobFile {
  Prepared job;                      // without its capture, which a piece opens as far as it reads it
  uint64_t common_input_digest = 0;  // see capture/input_files.h, of the new folder
};

// Errors: WriteFailed.
Status writeJobFile(const std::string& job_folder, const JobFile& file);
// Errors: FileMissing; FileUnreadable (damaged, or of another version).
Result<JobFile> readJobFile(const std::string& job_folder);

}  // namespace fourdvt::reconstruct
