// SPDX-License-Identifier: Apache-2.0
// Plane sweep stereo inside the hull, on the GPU: matching costs per pixel and depth, then depth maps by semi-global
// matching, filtered by consistency between cameras. Order of calls: setFrame → costs….
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"
#include "gpu/device.h"
#include "reconstruct/stereo/sweep_cells.h"

namespace fourdvt::reconstruct {

constexpr int kMaxLabels = 128;  // planes per pixel

struct StereoReference {
  PinholeCamera camera;         // size of the reduced pictures
  std::vector<size_t> sources;  // the camera itself, and those that its patches are compared with
};

// Matching costs of a band of depths at each pixel of a part of the reference picture. Plane k lies at depth k ·
// `step_m` along the optical axis, for all pixels.
struct CostVolume {
  static constexpr uint8_t kOutside = 255;  // not inside the hull
  int x = 0, y = 0, width = 0, height = 0;  // reference pixels
  int labels = 0;                           // a multiple of 4
  float step_m = 0;
  std::vector<int> first_plane;  // height × width; label l is plane first_plane + l; kNone: no hull
  std::vector<uint8_t> costs;    // height × width × labels
  static constexpr int kNone = -1;
};

struct DepthMap {
  PinholeCamera camera;
  int x = 0, y = 0, width = 0, height = 0;  // stored part of the camera's picture
  std::vector<float> depth_m;               // height × width along the optical axis; 0: unknown
  std::vector<float> weight;                // 0 … 1: confidence
  std::vector<float> front_m;               // hull's front; 0: none
};

struct PlaneSweepOptions {
  int radius = 1;                  // patch of 2 radius + 1 samples along each side
  float spacing = 1.5f;            // between samples, pixels of the reduced picture
  float step_m = 0.004f;           // between planes, along the optical axis
  int labels = 64;                 // planes per pixel, from the hull's front; a multiple of 4, at most kMaxLabels
  float correlation_share = 0.6f;  // weight in the cost; the rest is the difference of mean colours
};

class PlaneSweep {
 public:
  // Takes the reduced pictures' cameras; borrows `device`. Errors: GpuFailure.
  static Result<PlaneSweep> create(gpu::Device& device, std::span<const PinholeCamera> cameras,
                                   const PlaneSweepOptions& options);
  // RGBA of the cameras' sizes, alpha = matte. Errors: GpuFailure.
  Status setFrame(std::span<const Image> pictures, const TriangleMesh& hull);
  // Costs in the band behind the hull's front. Width 0 if the reference has no hull in its picture. Errors: GpuFailure.
  Result<CostVolume> costs(const StereoReference& reference);

 private:
  Result<gpu::ProgramId> programFor(size_t sources);
  Status drawFront(const PinholeCamera& camera, const PictureRegion& region);
  Status uploadCells(const std::vector<uint8_t>& cells, const PictureRegion& region);

  gpu::Device* device_ = nullptr;
  std::vector<PinholeCamera> cameras_;
  PlaneSweepOptions options_;
  int layer_width_ = 0, layer_height_ = 0;
  gpu::Program front_program_, outside_program_;
  std::vector<gpu::Program> cost_programs_;  // [number of sources]
  gpu::IndexBuffer corners_;                 // the faces of the hull
  gpu::Texture pictures_, positions_, front_, cells_, costs_;
  gpu::Target front_target_, costs_target_;
  std::vector<MatteCounts> mattes_;  // [camera]
  Positions hull_;
  int corner_count_ = 0, position_rows_ = 0;
  int front_width_ = 0, front_height_ = 0, cells_width_ = 0, cells_height_ = 0;
  int costs_width_ = 0, costs_height_ = 0;
};

struct SemiGlobalOptions {
  int step_penalty = 12;  // penalty for a neighbour one plane away; costs are 0 … 254
  int jump_penalty = 60;  // penalty for a neighbour further away
  int front_bias = 12;    // per plane, in the sum over eight directions: untextured surfaces stay at the hull
};

// Semi-global matching along eight directions, with depths interpolated between planes. Depth 0: no candidate. The
// weight grows with the margin over other depths and with the agreement of the pictures. An empty volume gives an empty
// map.
//
// Source: Heiko Hirschmüller: Stereo Processing by Semiglobal Matching and Mutual Information. IEEE Transactions on
// Pattern Analysis and Machine Intelligence 30(2), 2008.
DepthMap semiGlobalDepth(const StereoReference& reference, const CostVolume& volume, const SemiGlobalOptions& options);

// Depth of the map at a pixel of its camera; 0 where unknown or outside.
float depthAt(const DepthMap& map, double x, double y);

// Multiplies the weights with the squared cosine between normal and ray, since depths at grazing angles are inaccurate.
void weighByAngle(DepthMap& map);

// Sets depths to 0 that another map sees through, or that no map confirms within `tolerance_m`. The weight of a whole
// map falls with its share of refuted depths, to zero where it equals that of chance.
void keepConsistent(std::span<DepthMap> maps, double tolerance_m);

}  // namespace fourdvt::reconstruct
