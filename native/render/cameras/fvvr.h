// SPDX-License-Identifier: Apache-2.0
// The papers' benchmark: free-viewpoint video rendering (LVDT 2, 4; "FVVR"). The mesh is textured at render time from
// all camera pictures, each with a depth map of the mesh drawn from that camera; the M cameras closest to the view are
// blended by LVDT Eq. 3-4. Native evaluation only: not part of the wasm player.
// A depth map that is too coarse lets an occluder's texture fall onto what lies behind its outline ("shadow leak",
// OVH03 5.2.2; depth_maps.h). Does NOT read captures, does NOT clean the matte's edge, and needs every camera's picture
// of the frame in GPU memory: that is the point of the layers. With M < N cameras per frame, only their pictures are
// uploaded and their depth maps drawn; textures for all N stay allocated, because the next view takes other cameras.
// Characters from cameras are drawn by a Method (camera_method.h). Order of calls: setFrame (or its three parts) →
// draw….
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"
#include "gpu/device.h"
#include "render/cameras/depth_maps.h"
#include "render/view.h"

namespace fourdvt::render {

struct FvvrOptions {
  int closest = 0;          // M of N: cameras that look most as the view does (camerasTowards); 0: all
  glm::vec4 background{0};  // premultiplied
  int samples = 4;
  bool fills = true;  // surface that no camera sees; else it is left transparent
};

class Fvvr {
 public:
  // 1 to 31 cameras, of any sizes. length_scale: as CharacterModel's. Errors: InvalidArgument, GpuFailure.
  static Result<std::unique_ptr<Fvvr>> create(gpu::Device& device, std::span<const PinholeCamera> cameras,
                                              const MeshTopology& topology, const DepthMapOptions& maps = {},
                                              float length_scale = 1);
  virtual ~Fvvr() = default;
  // The cameras that a draw of this view uses, nearest first: `options.closest` of them.
  virtual std::vector<size_t> camerasOf(const View& view, const FvvrOptions& options) const = 0;
  // RGBA pictures (alpha = matte), one per camera, of the camera's size. Uploads them and draws their depth maps.
  // Shown only where the interpolated matte is above one half. `cameras`: the indices of those that the draws until the
  // next call use (camerasOf), no others are uploaded or drawn, and their pictures may be empty; an empty list: all.
  // Errors: InvalidArgument.
  virtual Status setFrame(const Positions& positions, std::span<const Image> pictures,
                          std::span<const size_t> cameras = {}) = 0;
  // The parts of setFrame, in order; for measuring. Pictures are uploaded round the mesh only.
  virtual Status setGeometry(const Positions& positions, std::span<const size_t> cameras = {}) = 0;
  virtual Status uploadPictures(std::span<const Image> pictures) = 0;
  virtual void drawDepthMaps() = 0;
  // Output as of Recipe::draw: premultiplied, at (0,0) of `target`. A covered fragment that no camera sees takes the
  // colour of the camera that faces it best in spite of occlusion; black if it lies outside every matte.
  // Errors: InvalidArgument (also where a camera of this view was left out of the frame).
  virtual Status draw(const View& view, const FvvrOptions& options, gpu::TargetId target) = 0;
  // RGBA straight alpha, top row first.
  virtual Result<Image> renderStill(const View& view, const FvvrOptions& options) = 0;
};

}  // namespace fourdvt::render
