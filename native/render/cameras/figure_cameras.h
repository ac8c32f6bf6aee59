// SPDX-License-Identifier: Apache-2.0
// What a method keeps of one figure from picture to picture: the cameras that the view chooses, their depth maps, and
// colours for what none of them sees. What neither geometry, picture nor choice of cameras has changed is kept.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/cameras/camera_blend.h"

namespace fourdvt::render {

class FigureCameras {
 public:
  // Chooses the `options.closest` cameras that have a picture and see something of the surface, at most `most`; draws
  // their depth maps and fills what they do not see. `also`: cameras that are added as far as they have a picture and
  // there is room. Errors: GpuFailure, InvalidArgument (no camera has a picture).
  Status prepare(gpu::Device& device, const CharacterModel& model, const CameraLook& look, const CharacterView& view,
                 const MethodOptions& options, int most = kMaxBlendedCameras, std::span<const size_t> also = {});

  // After prepare with the same arguments.
  const std::vector<size_t>& chosen() const { return chosen_; }  // nearest first, then those of `also`
  size_t nearestCount() const { return nearest_; }               // of `chosen`: without those of `also`
  const DepthMaps& maps() const { return *maps_; }
  float lengthScale() const { return length_scale_; }  // the model's
  CameraUniforms uniforms(const CameraLook& look, const MethodOptions& options) const;
  // What a program is made with that includes camera_blend.glsl (with camera_shade.glsl: FILLED too).
  std::string defines(const CameraLook& look, const MethodOptions& options) const;
  // Uniforms and textures of camera_surface.vert and camera_shade.glsl that are not CameraUniforms'.
  void addTo(gpu::Draw& draw, const CharacterView& view, const MethodOptions& options) const;

 private:
  void setRegions(const CharacterModel& model, const CameraLook& look);
  void choose(const CameraLook& look, const CharacterView& view, const MethodOptions& options, int most,
              std::span<const size_t> also);
  Status makeMaps(gpu::Device& device, const CameraLook& look, const MethodOptions& options);
  Status fill(gpu::Device& device, const CharacterModel& model, const CameraLook& look, const MethodOptions& options);

  std::optional<DepthMaps> maps_;
  DepthMapOptions map_options_;
  std::vector<PinholeCamera> cameras_;  // that the maps are of
  int layers_ = 0;
  std::vector<PictureRegion> regions_;
  uint64_t regions_serial_ = 0;  // geometry
  UnseenFill fill_;
  uint64_t fill_geometry_ = 0, fill_picture_ = 0;
  std::vector<size_t> fill_cameras_;
  float fill_least_cosine_ = 0;
  std::vector<size_t> chosen_;
  size_t nearest_ = 0;
  int fills_ = 0;
  float length_scale_ = 1;
};

// How the pictures of a look are bound.
BlendPictures picturesOf(const CameraLook& look);

}  // namespace fourdvt::render
