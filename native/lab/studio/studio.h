// SPDX-License-Identifier: Apache-2.0
// The virtual studio: an actor, rendered from a ring of cameras, written as a capture folder (capture.h) with held-out
// pictures, and for a motion class with the truth between its members (truth.h). Every imperfection of a real capture
// is a knob, and one seed drives all randomness: the same options give the same bytes.
//
// In place of a green studio there may be a furnished room (room.h): then the actor throws a shadow, the plates are
// recorded with noise, and the capture has no mattes of its own; the true ones lie in mattes_true/SEQUENCE/maskNN.
//
// Order of calls: options.check() → runStudio. Does NOT model motion blur, shadows on the actor or rolling shutter;
// held-out pictures and truth are a pinhole's.
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
  double drift_mm =
      0;  // how far appearance slides over the tracked mesh between the first and last member of a class, at most
  double wrinkles = 0;   // 0…1: contrast of folds whose place on the cloth depends on the motion and its phase
  double specular = 0;   // 0…1: strength of a highlight that moves with the camera
  double shading = 0.5;  // 0…1: strength of the studio's fixed lights; 0: the texture's colours as they are
  bool plain = false;    // the actor is of one colour: the mean of its texture
  // How the capture departs from the truth. σ: standard deviation of a normal distribution, drawn once per camera.
  double rotation_deg = 0;       // σ of the written calibration's rotation
  double translation_mm = 0;     // σ of each component of the written calibration's position
  double focal_percent = 0;      // σ of the written focal length
  double proxy_mm = 0;           // largest distance of the written mesh from the surface, along its normals, smooth
  double mesh_cell_mm = 25;      // procedural actor: size of the tracked mesh's faces
  double gain_percent = 0;       // σ of each colour channel's gain
  std::array<double, 3> lens{};  // k1, k2, k3 of the lens (capture.h) that the ring's cameras film through
  double offset_frames = 0;      // σ of each ring camera's lag behind the frame's time, in frames
  double soft_shadow_m = 0;      // the room: radius of the penumbra across the light; 0: a hard edge
  double plate_move_pixels = 0;  // the room: how far off the pictures the plates are, in the middle
  double exposure_drift_percent = 0;       // at most: how the gain strays from the plates' over a clip
  double white_balance_drift_percent = 0;  // at most: how red strays up while blue strays down, and back
  double noise_levels = 0;                 // σ of sensor noise in levels of 255, drawn anew for every pixel and frame
  double erosion_pixels = 0;               // how much too small the mattes are
};

struct StudioClass {
  std::string name, parameter;  // "locomotion", "speed_mps"
  std::vector<std::string> members;
};

struct StudioOptions {
  std::string actor = "procedural";    // or a path to .glb or .gltf
  std::string folder;                  // the folder to write
  std::vector<std::string> sequences;  // empty: all animations of the actor (procedural: walk and run)
  std::vector<StudioClass>
      classes;                    // empty: the procedural actor with two or more motions makes locomotion by speed_mps
  int cameras = 8;                // on the ring
  int frames = 0;                 // of each sequence, from its start, which is then no loop and in no class; 0: all
  int width = 480, height = 640;  // pixels, both even
  double fps = 25;
  int test_every = 8;  // every Nth frame has held-out pictures
  std::vector<double> truth_at{0,   0.2, 0.4,
                               0.6, 0.8, 1};  // 0: the first member … 1: the last; empty: no truth is written
  int truth_phases = 8;
  int truth_ring = 2;      // how many ring cameras the truth is rendered from, besides the held-out ones
  bool images = false;     // PNG pictures and mattes instead of videos
  bool room = false;       // a furnished room instead of the green studio
  double scale = 1;        // the written world's size beside the actor's own; pictures stay as they are
  bool bystander = false;  // the room: a second person, whom the cameras across see
  double room_size_m = 0;  // length of the room's walls; 0: as the cameras need
  int plates = 1;          // pictures of the empty room per camera; 0: none
  StudioKnobs knobs;
  std::string check() const;  // what is wrong; empty if nothing is
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

// Writes into FOLDER.work and renames it at the end. Replaces an earlier studio capture, but never another folder.
// Errors: InvalidArgument, WriteFailed, Interrupted, GpuFailure, those of openGltfActor.
Result<StudioReport> runStudio(const StudioOptions& options, const StudioEnvironment& environment);

}  // namespace fourdvt::studio
