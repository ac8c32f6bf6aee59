// SPDX-License-Identifier: Apache-2.0
// The virtual studio: an actor, rendered from a ring of cameras, written as a capture folder (capture.h) with held-out
// pictures, and for a motion class with the truth between its members (truth.h). Each imperfection of a real capture is
// a knob, and one seed drives all randomness: the same options give the same bytes.
//
// A furnished room (room.h) may replace the green studio: then the actor casts a shadow, the plates are recorded with
// noise, and the capture has no mattes of its own; the true ones lie in mattes_true/SEQUENCE/maskNN.
//
// Order of calls: options.check() → runStudio. Motion blur, shadows on the actor and rolling shutter are not modelled;
// held-out pictures and truth have no lens distortion.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "gpu/device.h"

namespace fourdvt::studio {

struct StudioKnobs {
  uint32_t seed = 1;
  // The actor.
  double drift_mm = 0;         // maximum slide of appearance over the tracked mesh, a class's first to last member
  double wrinkles = 0;         // 0…1: contrast of cloth folds whose position depends on the motion and its phase
  double specular = 0;         // 0…1: strength of a view-dependent highlight
  double shading = 0.5;        // 0…1: strength of the studio's fixed lights; 0: unshaded texture
  bool plain = false;          // single-coloured actor: the mean of its texture
  bool plain_clothes = false;  // procedural actor: each garment of one colour
  // Deviations of the capture from the truth. σ: standard deviation of a normal distribution, drawn once per camera.
  double rotation_deg = 0;       // σ of the written calibration's rotation
  double translation_mm = 0;     // σ of each component of the written calibration's position
  double focal_percent = 0;      // σ of the written focal length
  double proxy_mm = 0;           // maximum distance of the written mesh from the surface, along its normals, smooth
  double mesh_cell_mm = 25;      // procedural actor: size of the tracked mesh's faces
  double gain_percent = 0;       // σ of each colour channel's gain
  std::array<double, 3> lens{};  // k1, k2, k3 of the ring cameras' lens (capture.h)
  double offset_frames = 0;      // σ of each ring camera's lag behind the frame's time, in frames
  double soft_shadow_m = 0;      // room: radius of the penumbra across the light; 0: a hard edge
  double plate_move_pixels = 0;  // room: shift of the plates against the pictures, at the centre
  double exposure_drift_percent = 0;       // maximum gain drift from the plates over a clip
  double white_balance_drift_percent = 0;  // maximum opposite drift of red and blue
  double noise_levels = 0;                 // σ of sensor noise in levels of 255, per pixel and frame
  double erosion_pixels = 0;               // erosion of the mattes
};

struct StudioClass {
  std::string name, parameter;  // "locomotion", "speed_mps"
  std::vector<std::string> members;
};

struct StudioOptions {
  std::string actor = "procedural";    // or a path to .glb or .gltf
  std::string folder;                  // output folder
  std::vector<std::string> sequences;  // empty: all animations of the actor (procedural: walk and run)
  std::vector<StudioClass> classes;  // empty: the procedural actor with two or more gaits makes locomotion by speed_mps
  int cameras = 8;                   // on the ring
  int frames = 0;                    // per sequence, from its start, then without loops and classes; 0: all
  double strides = 0;             // strides of a gait, which is then a clip with an end and in no class; 0: one, a loop
  bool travel = false;            // these strides lead through the middle of the stage
  int width = 480, height = 640;  // pixels, both even
  double fps = 25;
  int test_every = 8;  // held-out pictures at each Nth frame
  std::vector<double> truth_at{0,   0.2, 0.4,
                               0.6, 0.8, 1};  // 0: the first member … 1: the last; empty: no truth is written
  int truth_phases = 8;
  int truth_ring = 2;      // number of ring cameras of the truth, besides the held-out ones
  bool images = false;     // PNG pictures and mattes instead of videos
  bool room = false;       // a furnished room instead of the green studio
  double scale = 1;        // written world's size relative to the actor's; pictures are unchanged
  bool bystander = false;  // room: a second person, visible in the cameras across
  double room_size_m = 0;  // length of the room's walls; 0: minimum for the cameras
  int plates = 1;          // pictures of the empty room per camera; 0: none
  StudioKnobs knobs;
  std::string check() const;  // error message; empty if valid
};

struct StudioProgress {
  std::string step;
  uint32_t done = 0, total = 0;  // pictures
};

struct StudioEnvironment {
  gpu::Device* device = nullptr;
  std::function<void(const StudioProgress&)> progress;  // may be empty
  const std::atomic<bool>* stop = nullptr;              // may be null
};

struct StudioReport {
  uint32_t vertices = 0, faces = 0, frames = 0, pictures = 0;
};

// Writes into FOLDER.work and renames it at the end. Replaces an earlier studio capture; other folders are an error.
// Errors: InvalidArgument, WriteFailed, Interrupted, GpuFailure, those of openGltfActor.
Result<StudioReport> runStudio(const StudioOptions& options, const StudioEnvironment& environment);

}  // namespace fourdvt::studio
