// SPDX-License-Identifier: Apache-2.0
// The star form of Floating Textures: flow from the mean of a view's pictures to each of them, n flows a round. The
// first round, at a quarter of the view's size, displaces the pictures by what it found; their new mean is sharper, and
// the second round starts from it, at half the size. Does NOT choose cameras and does NOT draw the surface.
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
  struct Sources {
    gpu::TextureId weights = 0;                        // of FloatingPictures
    std::vector<gpu::TextureId> pictures, flows = {};  // by rank; flows RG16F, in pixels of the weights; none for None
  };
  // Pictures, flows and target may be smaller than the weights. Errors: GpuFailure.
  Status draw(gpu::Device& device, const Sources& sources, Warp warp, const PictureGroup& target);

 private:
  std::map<std::string, gpu::Program> programs_;  // by their defines
};

class FloatingStar {
 public:
  // Errors: Unsupported: the device has no half-float targets.
  static Result<FloatingStar> create(gpu::Device& device);
  // Errors: GpuFailure.
  Status update(gpu::Device& device, const FloatingPictures& pictures, PictureBlend& blend);
  // By rank, RG16F, of the last round's size, in the pictures' pixels: the mean at p resembles picture i at p + flow i.
  std::vector<gpu::TextureId> flows() const { return texturesOf(rounds_.back().flows); }

 private:
  struct Round {
    std::unique_ptr<FlowSource> source;
    std::vector<PictureGroup> flows;  // by rank, of the round's size
  };
  static std::vector<gpu::TextureId> texturesOf(const std::vector<PictureGroup>& groups);

  std::vector<Round> rounds_;
  PictureGroup mean_;  // where a round starts; half of the view's size
  FlowSum sum_;
};

}  // namespace fourdvt::render
