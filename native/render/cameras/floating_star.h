// SPDX-License-Identifier: Apache-2.0
// The star form of Floating Textures: flow from the mean of a view's pictures to each of them, n flows a round. A round
// displaces the pictures by what it found; their new mean is sharper, and the next round starts from it. The early
// rounds have a quarter of the view's size, the last one half of it. Does NOT choose cameras and does NOT draw the
// surface.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>

#include "render/cameras/floating_pictures.h"

namespace fourdvt::render {

// The pictures of a view, blended by their weights.
class PictureBlend {
 public:
  enum class Warp { None, Star, Pairs };  // how flows displace; camera_floating_blend.frag
  // flows: RG16F by rank, of the pictures' size; none for Warp::None. Errors: GpuFailure.
  Status draw(gpu::Device& device, const FloatingPictures& pictures, std::span<const gpu::TextureId> flows, Warp warp,
              gpu::TargetId target);

 private:
  std::map<std::string, gpu::Program> programs_;  // by their defines
};

class FloatingStar {
 public:
  // Errors: Unsupported: the device has no half-float targets.
  static Result<FloatingStar> create(gpu::Device& device);
  // mean: RGBA8 of the pictures' size, overwritten. Errors: GpuFailure.
  Status update(gpu::Device& device, const FloatingPictures& pictures, PictureBlend& blend, const PictureGroup& mean);
  // By rank, RG16F, of the pictures' size and in their pixels: the mean at p resembles picture i at p + flow i.
  std::vector<gpu::TextureId> flows() const;

 private:
  std::vector<std::unique_ptr<FlowSource>> rounds_;
  std::vector<PictureGroup> flows_;  // by rank
  FlowSum sum_;
};

}  // namespace fourdvt::render
