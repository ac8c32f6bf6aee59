// SPDX-License-Identifier: Apache-2.0
// Per-figure state of a method between pictures: the cameras chosen for the view, their depth maps, and the colours of
// surface that none of them sees. Results are reused while geometry, picture and chosen cameras are unchanged.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/cameras/camera_blend.h"

namespace fourdvt::render {

class FigureCameras {
 public:
  // Chooses the `options.closest` cameras that have a picture and see part of the surface, at most `most`; draws their
  // depth maps and fills the surface they do not see. also: cameras added while there is room, if they have a picture.
  // Errors: GpuFailure, InvalidArgument (no camera has a picture).
  Status prepare(gpu::Device& device, const CharacterModel& model, const CameraLook& look, const CharacterView& view,
                 const MethodOptions& options, int most = kMaxBlendedCameras, std::span<const size_t> also = {});

  // Valid after prepare with the same arguments.
  const std::vector<size_t>& chosen() const { return chosen_; }  // nearest first, then those of `also`
  size_t nearestCount() const { return nearest_; }               // size of `chosen` without `also`
  const DepthMaps& maps() const { return *maps_; }
  float lengthScale() const { return length_scale_; }  // the model's
  CameraUniforms uniforms(const CameraLook& look, const MethodOptions& options) const;
  // Returns the defines of programs that include camera_blend.glsl (with camera_shade.glsl: FILLED too).
  std::string defines(const CameraLook& look, const MethodOptions& options) const;
  // Adds the uniforms and textures of camera_surface.vert and camera_shade.glsl beyond CameraUniforms.
  void addTo(gpu::Draw& draw, const CharacterView& view, const MethodOptions& options) const;

 private:
  void setRegions(const CharacterModel& model, const CameraLook& look);
  void choose(const CameraLook& look, const CharacterView& view, const MethodOptions& options, int most,
              std::span<const size_t> also);
  Status makeMaps(gpu::Device& device, const CameraLook& look, const MethodOptions& options);
  Status fill(gpu::Device& device, const CharacterModel& model, const CameraLook& look, const MethodOptions& options);

  std::optional<DepthMaps> maps_;
  DepthMapOptions map_options_;
  std::vector<PinholeCamera> cameras_;  // cameras of the maps
  int layers_ = 0;
  std::vector<PictureRegion> regions_;
  uint64_t regions_serial_ = 0;  // geometry serial of the regions
  UnseenFill fill_;
  uint64_t fill_geometry_ = 0, fill_picture_ = 0;
  std::vector<size_t> fill_cameras_;
  float fill_min_cosine_ = 0;
  std::vector<size_t> chosen_;
  size_t nearest_ = 0;
  int fills_ = 0;
  float length_scale_ = 1;
};

// Returns the binding of a look's pictures.
BlendPictures picturesOf(const CameraLook& look);

}  // namespace fourdvt::render
