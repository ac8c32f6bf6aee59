// SPDX-License-Identifier: Apache-2.0
// What `fourdvt reconstruct` is asked for, and what it needs from the program that runs it.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/video.h"
#include "gpu/device.h"

namespace fourdvt::reconstruct {

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
  int fairing = 0;                  // rounds, see fairing.h
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

}  // namespace fourdvt::reconstruct
