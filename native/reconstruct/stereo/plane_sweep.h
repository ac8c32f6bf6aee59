// SPDX-License-Identifier: Apache-2.0
// Compares the pictures on planes inside the hull, on the GPU. Does NOT decide where the surface is.
// Order of calls: setFrame → costs….
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"
#include "gpu/device.h"

namespace fourdvt::reconstruct {
// What one camera, with its neighbours' help, says about the surface: costs of depths, and a depth, per pixel. Does NOT
// compute them.

constexpr int kMaxLabels = 128;  // planes per pixel

struct StereoReference {
  PinholeCamera camera;         // of the size of the reduced pictures
  std::vector<size_t> sources;  // whose patches are compared: the first with each of the others
};

// Costs of a band of depths at each pixel of a part of a reference's picture. Depths are planes, the same for all
// pixels: number k lies at k times `step_m` along the optical axis.
struct CostVolume {
  static constexpr uint8_t kOutside = 255;  // not inside the hull
  int x = 0, y = 0, width = 0, height = 0;  // pixels of the reference
  int labels = 0;                           // a multiple of 4
  float step_m = 0;
  std::vector<int> first_plane;  // height × width; the label l means plane first_plane + l; kNone: no hull
  std::vector<uint8_t> costs;    // height × width × labels
  static constexpr int kNone = -1;
};

struct DepthMap {
  PinholeCamera camera;
  int x = 0, y = 0, width = 0, height = 0;  // the part of the camera's picture that is kept
  std::vector<float> depth_m;               // height × width along the optical axis; 0: unknown
  std::vector<float> weight;                // 0 … 1: how much it is trusted
  std::vector<float> front_m;               // of the hull; 0: none
};

struct PlaneSweepOptions {
  int radius = 1;                  // of a patch: 2 radius + 1 samples along each side
  float spacing = 1.5f;            // of its samples, pixels of the reduced picture
  float step_m = 0.004f;           // between planes, along the optical axis
  int labels = 64;                 // planes per pixel, from the hull's front; a multiple of 4, at most kMaxLabels
  float correlation_share = 0.6f;  // of the cost; the rest is the difference of mean colours
};

class PlaneSweep {
 public:
  // Cameras of the reduced pictures. `device` is borrowed. Errors: GpuFailure.
  static Result<PlaneSweep> create(gpu::Device& device, std::span<const PinholeCamera> cameras,
                                   const PlaneSweepOptions& options);
  // RGBA of the cameras' sizes, alpha = matte. Errors: GpuFailure.
  Status setFrame(std::span<const Image> pictures, const TriangleMesh& hull);
  // Costs in the band inside the hull's front. Width 0 if the reference does not see the hull. Errors: GpuFailure.
  Result<CostVolume> costs(const StereoReference& reference);

 private:
  Result<gpu::ProgramId> programFor(size_t sources);
  Status drawFront(const PinholeCamera& camera, const PictureRegion& region);

  gpu::Device* device_ = nullptr;
  std::vector<PinholeCamera> cameras_;
  PlaneSweepOptions options_;
  int layer_width_ = 0, layer_height_ = 0;
  gpu::Program front_program_;
  std::vector<gpu::Program> cost_programs_;  // by number of sources
  gpu::Texture pictures_, corners_, positions_, front_, costs_;
  gpu::Target front_target_, costs_target_;
  Positions hull_;
  int corner_count_ = 0, corner_rows_ = 0, position_rows_ = 0;
  int front_width_ = 0, front_height_ = 0, costs_width_ = 0, costs_height_ = 0;
};

// From costs to depths: semi-global matching (H08 in algorithms/stereo.md) along eight directions, with depths between
// the planes.

struct SemiGlobalOptions {
  int step_penalty = 12;  // where a neighbour lies one plane away; costs are 0 … 254
  int jump_penalty = 60;  // where it lies further away
  int front_bias = 12;    // per plane, of the sum over eight directions: where nothing is textured, the hull stays
};

// A pixel without any candidate has depth 0. The weight says how much better the best depth is than any other, and how
// well the pictures agree there. An empty volume gives an empty map.
DepthMap semiGlobalDepth(const StereoReference& reference, const CostVolume& volume, const SemiGlobalOptions& options);

// Depth maps against each other: what no other one confirms is not trusted.

// Depth of the map at a pixel of its camera; 0 where unknown or outside.
float depthAt(const DepthMap& map, double x, double y);

// Multiplies the weights with the squared cosine between the surface and the ray: what a camera sees edge-on it
// measures badly.
void weighByAngle(DepthMap& map);

// Sets depths to 0 that another map looks through, or that none confirms to `tolerance_m`. A whole map loses weight the
// more of its depths others refute: from none where few are, to all where it is as many as by chance.
void keepConsistent(std::span<DepthMap> maps, double tolerance_m);

}  // namespace fourdvt::reconstruct
