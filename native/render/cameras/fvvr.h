// SPDX-License-Identifier: Apache-2.0
// Free-viewpoint video rendering, the benchmark of LVDT (2, 4; "FVVR"): the mesh is textured at render time from all N
// camera pictures, each with a depth map of the mesh from that camera; the M cameras closest to the view are blended by
// LVDT Eq. 3-4. Native evaluation only; excluded from the wasm player. A coarse depth map lets an occluder's texture
// leak onto the surface behind its outline ("shadow leak", OVH03 5.2.2; depth_maps.h). Matte edges are used as given.
// Every camera's picture of the frame is in GPU memory, a cost that layers avoid. With M < N cameras per frame, only
// their pictures are uploaded and their depth maps drawn; textures for all N stay allocated for later views. Characters
// from cameras are drawn by a Method (camera_method.h). Order of calls: setFrame (or its three parts) → draw….
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"
#include "gpu/device.h"
#include "render/cameras/camera_blend.h"
#include "render/cameras/depth_maps.h"
#include "render/view.h"

namespace fourdvt::render {

// Defaults: the papers' form.
struct FvvrOptions {
  int closest = 0;          // M of N: cameras nearest in angle to the view (camerasTowards); 0: all
  glm::vec4 background{0};  // premultiplied
  int samples = 4;
  Unseen unseen = Unseen::BestFacing;  // Neighbourhood: from all cameras of the frame
  float facing_exponent = 1;           // power of cos(surface normal, ray to the camera)
  float view_exponent = 1;             // power of cos(ray to the camera, ray to the eye)
  float min_cosine = 0;                // cosine of surface normal and ray below which a camera is rejected
  bool sharp = false;                  // Catmull-Rom without background pixels (sharp_filter.glsl); false: bilinear
};

// The best options at the held-out cameras of the sample's walk (algorithms/cameras.md).
FvvrOptions tunedFvvr();

class Fvvr {
 public:
  // Makes a renderer for 1 to 31 cameras of any sizes. length_scale: as CharacterModel's. Errors: InvalidArgument,
  // GpuFailure.
  static Result<std::unique_ptr<Fvvr>> create(gpu::Device& device, std::span<const PinholeCamera> cameras,
                                              const MeshTopology& topology, const DepthMapOptions& maps = {},
                                              float length_scale = 1);
  // Returns the `options.closest` cameras of a draw of this view, nearest first.
  std::vector<size_t> camerasOf(const View& view, const FvvrOptions& options) const;
  // Uploads the RGBA pictures (alpha = matte), one per camera at the camera's size, and draws their depth maps. Surface
  // is shown where the interpolated matte is above one half. cameras: those in use until the next call (camerasOf); the
  // others are skipped, and their pictures may be empty; an empty list: all. Errors: InvalidArgument.
  Status setFrame(const Positions& positions, std::span<const Image> pictures, std::span<const size_t> cameras = {});
  // Parts of setFrame in order, for timing. Pictures are uploaded round the mesh only.
  Status setGeometry(const Positions& positions, std::span<const size_t> cameras = {});
  Status uploadPictures(std::span<const Image> pictures);
  void drawDepthMaps();
  // Draws like Recipe::draw: premultiplied, at (0,0) of `target`. BestFacing is black outside every matte. Errors:
  // InvalidArgument (also where a camera of this view is missing from the frame).
  Status draw(const View& view, const FvvrOptions& options, gpu::TargetId target);
  // Returns straight RGBA, top row first.
  Result<Image> renderStill(const View& view, const FvvrOptions& options);

 private:
  struct Camera {
    bool is_used = true;       // used in the current frame
    bool has_picture = false;  // uploaded since the camera came into use
  };
  struct Size {
    int width = 0, height = 0, samples = 0;
    bool operator==(const Size&) const = default;
  };

  Fvvr(gpu::Device& device, std::span<const PinholeCamera> cameras);
  Status prepare(const MeshTopology& topology, const DepthMapOptions& maps, float length_scale);
  Status useCameras(std::span<const size_t> cameras);
  Status checkPicture(const PinholeCamera& camera, const Image& picture) const;
  Status checkDraw(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const;
  std::vector<size_t> usedCameras() const;
  void drawMesh(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const;
  Status prepareProgram(const FvvrOptions& options, size_t camera_count);
  // Updates the colours of unseen vertices from all cameras of the frame.
  Status fillUnseen(const FvvrOptions& options);
  CameraUniforms uniformsOf(const FvvrOptions& options, std::span<const size_t> cameras) const;
  Status resizeScene(const Size& size);
  Status resizeStill(int width, int height);

  gpu::Device& device_;
  const std::vector<PinholeCamera> pinholes_;
  std::vector<Camera> cameras_;
  std::vector<PictureRegion> regions_;  // [camera] part of its picture that the current mesh covers
  CharacterModel model_;
  std::optional<DepthMaps> maps_;
  // Size of the largest camera's picture; smaller ones use part of their layers.
  int picture_width_ = 0, picture_height_ = 0;
  gpu::Texture pictures_;
  std::map<std::string, gpu::Program> programs_;  // keyed by defines
  UnseenFill fill_;
  std::optional<float> fill_min_cosine_;  // its limit; nullopt: the fill is outdated
  gpu::Target scene_;
  Size scene_size_;
  gpu::Texture still_color_;
  gpu::Target still_;
  Size still_size_;
  std::vector<uint8_t> pixels_;  // scratch
};

}  // namespace fourdvt::render
