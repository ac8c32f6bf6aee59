// SPDX-License-Identifier: Apache-2.0
// The virtual studio: an actor, rendered from a ring of cameras, written as a capture folder (capture.h) with held-out
// pictures, and for a motion class with the truth between its members (studio_truth.h). Every imperfection of a real
// capture is a knob, with a seed; the same options give the same bytes.
//
// Order of calls: options.check() → runStudio. Does NOT model motion blur, lens distortion, shadows or rolling shutter.
#pragma once

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
  double drift_mm = 0;   // most that appearance slides over the tracked mesh between a class's first and last member
  double wrinkles = 0;   // 0…1: contrast of folds whose place on the cloth depends on the motion and its phase
  double specular = 0;   // 0…1: strength of a highlight that moves with the camera
  double shading = 0.5;  // 0…1: of the studio's fixed lights; 0: the texture's colours as they are
  // Between truth and capture. σ: standard deviation of a normal distribution, drawn once a camera.
  double rotation_deg = 0;    // σ of the written calibration's rotation
  double translation_mm = 0;  // σ of each component of the written calibration's position
  double focal_percent = 0;   // σ of the written focal length
  double proxy_mm = 0;        // largest distance of the written mesh from the surface, along its normals, smooth
  double mesh_cell_mm = 25;   // procedural actor: size of the tracked mesh's faces
  double gain_percent = 0;    // σ of each colour channel's gain
  double noise_levels = 0;    // σ of sensor noise, of 255, drawn anew a pixel and frame
  double erosion_pixels = 0;  // mattes are this much too small
};

struct StudioClass {
  std::string name, parameter;  // "locomotion", "speed_mps"
  std::vector<std::string> members;
};

struct StudioOptions {
  std::string actor = "procedural";    // or a path to .glb or .gltf
  std::string folder;                  // to write
  std::vector<std::string> sequences;  // empty: all that the actor has (procedural: walk and run)
  std::vector<StudioClass> classes;    // empty: procedural with two or more motions: locomotion by speed_mps
  int cameras = 8;                     // on the ring
  int width = 480, height = 640;       // pixels, even
  double fps = 25;
  int test_every = 8;                                      // held-out pictures: every Nth frame
  std::vector<double> truth_at{0, 0.2, 0.4, 0.6, 0.8, 1};  // 0: first member … 1: last one; empty: no truth
  int truth_phases = 8;
  int truth_ring = 2;   // ring cameras that the truth is rendered from, besides the held-out ones
  bool images = false;  // PNG pictures and mattes instead of videos
  StudioKnobs knobs;
  std::string check() const;  // empty: fine; else what is wrong
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

// Writes into FOLDER.work and renames at the end. Replaces an earlier studio capture, never another folder.
// Errors: InvalidArgument, WriteFailed, Interrupted, GpuFailure, those of openGltfActor.
Result<StudioReport> runStudio(const StudioOptions& options, const StudioEnvironment& environment);

}  // namespace fourdvt::studio
