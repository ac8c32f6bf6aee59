// SPDX-License-Identifier: Apache-2.0
// What Floating Textures blends and warps: the picture of each camera on the surface as a view sees it, and each
// camera's weight per pixel with soft visibility (FT 4.2). Works at the view's size. Does NOT compute flow.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>

#include "render/cameras/figure_cameras.h"
#include "render/flow/flow.h"

namespace fourdvt::render {

// Textures of one size that are drawn together.
struct PictureGroup {
  std::vector<gpu::Texture> textures;
  gpu::Target target;
  int width = 0, height = 0;
};

// Makes it anew unless it has this size and number of textures; drawn with a depth buffer of its own or without.
// Errors: GpuFailure.
Status resizeGroup(gpu::Device& device, int width, int height, const std::vector<gpu::PixelFormat>& formats,
                   bool has_depth, PictureGroup& out);

// FT Eq. 8 with exact distances, for four cameras at a time.
class SoftVisibility {
 public:
  static constexpr float kMostRadius_px = 128;
  // hidden: RGBA8, a channel per camera, 1 where the camera does not see the surface; weights: likewise, RGBA16F.
  // Draws weights × min(distance to the nearest hidden pixel / radius, 1). Errors: GpuFailure.
  Status update(gpu::Device& device, gpu::TextureId hidden, gpu::TextureId weights, int width, int height,
                float radius_px);
  gpu::TextureId texture() const { return soft_.textures[0].id(); }  // RGBA16F, of this size
  gpu::TargetId target() const { return soft_.target.id(); }         // to read it back

 private:
  gpu::Program across_program_, down_program_;
  PictureGroup across_, soft_;
};

class FloatingPictures {
 public:
  static constexpr int kMost = 4;  // cameras: as many channels as a texture has, and as many targets as a draw

  // `cameras` were prepared with the same arguments and at most kMost cameras; the view may be another one.
  // Errors: GpuFailure.
  Status update(gpu::Device& device, const CharacterModel& model, const CameraLook& look, const CharacterView& view,
                const MethodOptions& options, const FigureCameras& cameras);
  // The weights alone.
  Status updateWeights(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                       const CharacterView& view, const MethodOptions& options, const FigureCameras& cameras);
  // RGBA8, premultiplied, y up, by rank in FigureCameras::chosen; alpha 1 on the surface.
  gpu::TextureId picture(size_t rank) const { return pictures_.textures[rank].id(); }
  std::vector<gpu::TextureId> all() const;  // by rank
  size_t count() const { return pictures_.textures.size(); }
  int width() const { return pictures_.width; }
  int height() const { return pictures_.height; }
  // RGBA16F, a channel per rank: w Ω, not normalised; all 0 where no camera sees the surface.
  gpu::TextureId weights() const { return soft_.texture(); }

 private:
  Status drawSight(gpu::Device& device, const CharacterModel& model, const CameraLook& look, const CharacterView& view,
                   const MethodOptions& options, const FigureCameras& cameras);

  std::map<std::string, gpu::Program> sight_programs_, project_programs_;  // by their defines
  PictureGroup sight_, pictures_;
  SoftVisibility soft_;
};

// What a flow is found between.
enum class FloatingFlow {
  Pictures,      // two cameras' pictures of the view
  KeptPictures,  // two cameras' pictures in one's own view, kept for other views (floating.h)
  EarlyMean,     // the mean of the pictures, still blurred, and one of them: the star's first round
  LastMean,      // the same in its second round: the mean is nearly sharp and lies between the pictures
};

// The method and settings that scored best (algorithms/floating.md). `octaves`: how many times the flow's size is
// halved against the pictures'; its finest patches stay the same.
FlowOptions floatingFlow(FloatingFlow between, int octaves);

// How long a displacement may be (FlowSum's `most`), between two pictures and from their mean: shares of the view's
// height, in still mode of the camera picture's.
constexpr float kMostBetweenPictures = 0.0125f, kMostFromMean = 0.006f;

// Sums of flow fields, each weighted by one camera's share of the pixel (FT Eq. 6), in pixels of the weights. A flow of
// another size is sampled, and the target may have another size, too.
class FlowSum {
 public:
  struct Term {
    gpu::TextureId flow = 0;
    gpu::TextureId weights = 0;  // of FloatingPictures
    int rank = -1;               // whose share; -1: 1
    gpu::TextureId before = 0;   // the sum so far, of the target's size; 0: none
    float most = 1;      // of a displacement that counts in full, heights of the picture; at twice it, none does
    glm::vec2 scale{1};  // pixels of the weights per pixel of the target
  };
  Status draw(gpu::Device& device, const Term& term, gpu::TargetId target);  // RG16F. Errors: GpuFailure

 private:
  gpu::Program program_;
};

// The star form of Floating Textures: flow from the mean of a view's pictures to each of them, n flows a round. The
// first round, at a quarter of the view's size, displaces the pictures by what it found; their new mean is sharper, and
// the second round starts from it, at half the size. Does NOT choose cameras and does NOT draw the surface.

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
