// SPDX-License-Identifier: Apache-2.0
// Inputs and stages of Floating Textures: the picture of each camera on the surface in a view, camera weights per pixel
// with soft visibility (FT 4.2), sums of flow fields, and the blend from their mean. Works at the view's size.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>

#include "render/cameras/figure_cameras.h"
#include "render/flow/flow.h"

namespace fourdvt::render {

// Textures of equal size with one common target.
struct PictureGroup {
  std::vector<gpu::Texture> textures;
  gpu::Target target;
  int width = 0, height = 0;
};

// Remakes the group unless it has this size and number of textures. has_depth: adds a depth buffer. Errors: GpuFailure.
Status resizeGroup(gpu::Device& device, int width, int height, const std::vector<gpu::PixelFormat>& formats,
                   bool has_depth, PictureGroup& out);

// Soft visibility (FT Eq. 8) with exact distances, for four cameras at a time.
class SoftVisibility {
 public:
  static constexpr float kMaxRadius_px = 128;
  // Draws weights × min(distance to the nearest hidden pixel / radius, 1). hidden: RGBA8, a channel per camera, 1 where
  // the camera does not see the surface; weights: RGBA16F, a channel per camera. Errors: GpuFailure.
  Status update(gpu::Device& device, gpu::TextureId hidden, gpu::TextureId weights, int width, int height,
                float radius_px);
  gpu::TextureId texture() const { return soft_.textures[0].id(); }  // RGBA16F, width × height
  gpu::TargetId target() const { return soft_.target.id(); }         // for read-back

 private:
  gpu::Program across_program_, down_program_;
  PictureGroup across_, soft_;
};

class FloatingPictures {
 public:
  static constexpr int kMax = 4;  // maximum cameras: channels of a texture and colour targets of a draw

  // Requires `cameras` prepared with the same arguments and at most kMax cameras; the view may differ. Errors:
  // GpuFailure.
  Status update(gpu::Device& device, const CharacterModel& model, const CameraLook& look, const CharacterView& view,
                const MethodOptions& options, const FigureCameras& cameras);
  // Updates the weights alone.
  Status updateWeights(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                       const CharacterView& view, const MethodOptions& options, const FigureCameras& cameras);
  // RGBA8, premultiplied, y up, indexed by rank in FigureCameras::chosen; alpha 1 on the surface.
  gpu::TextureId picture(size_t rank) const { return pictures_.textures[rank].id(); }
  std::vector<gpu::TextureId> all() const;  // by rank
  size_t count() const { return pictures_.textures.size(); }
  int width() const { return pictures_.width; }
  int height() const { return pictures_.height; }
  // RGBA16F, a channel per rank: w Ω, unnormalised; all 0 where no camera sees the surface.
  gpu::TextureId weights() const { return soft_.texture(); }

 private:
  Status drawSight(gpu::Device& device, const CharacterModel& model, const CameraLook& look, const CharacterView& view,
                   const MethodOptions& options, const FigureCameras& cameras);

  std::map<std::string, gpu::Program> sight_programs_, project_programs_;  // keyed by defines
  PictureGroup sight_, pictures_;
  SoftVisibility soft_;
};

// Pictures compared by a flow.
enum class FloatingFlow {
  Pictures,      // two cameras' pictures of the view
  KeptPictures,  // two cameras' pictures in the view of one of them, kept for other views (floating.h)
  EarlyMean,     // the mean of the pictures, still blurred, and one of them: first round of the mean form
  LastMean,      // the same in the second round, where the mean is nearly sharp
};

// Returns the method and settings with the best score (algorithms/floating.md). octaves: halvings of the flow's size
// against the pictures'; the finest patches keep their size.
FlowOptions floatingFlow(FloatingFlow between, int octaves);

// Maximum displacement (FlowSum's `most`) between two pictures and from their mean, as shares of the view's height; of
// the camera picture's height in still mode.
constexpr float kMaxBetweenPictures = 0.0125f, kMaxFromMean = 0.006f;

// Sums flow fields, each weighted by one camera's share of the pixel (FT Eq. 6), in pixels of the weights. A flow that
// differs in size from the target is sampled.
class FlowSum {
 public:
  struct Term {
    gpu::TextureId flow = 0;
    gpu::TextureId weights = 0;  // FloatingPictures::weights
    int rank = -1;               // camera that gives the weight; -1: weight 1
    gpu::TextureId before = 0;   // partial sum of the target's size; 0: none
    float most = 1;  // displacement up to which the weight is full, heights of the picture; it falls to 0 at twice this
    glm::vec2 scale{1};  // pixels of the weights per pixel of the target
  };
  Status draw(gpu::Device& device, const Term& term, gpu::TargetId target);  // target: RG16F. Errors: GpuFailure

 private:
  gpu::Program program_;
};

// Blends the pictures of a view by their weights.
class PictureBlend {
 public:
  enum class Warp { None, Mean, Pairs };  // meaning of the flows; camera_floating_blend.frag
  struct Sources {
    gpu::TextureId weights = 0;                        // FloatingPictures::weights
    std::vector<gpu::TextureId> pictures, flows = {};  // by rank; flows RG16F, in pixels of the weights, empty for None
  };
  // Draws into the textures of `target`, which, like pictures and flows, may be smaller than the weights. Errors:
  // GpuFailure.
  Status draw(gpu::Device& device, const Sources& sources, Warp warp, const PictureGroup& target);

 private:
  std::map<std::string, gpu::Program> programs_;  // keyed by defines
};

// Mean form of Floating Textures: flow from the mean of a view's pictures to each of them, n flows a round. The first
// round, at a quarter of the view's size, displaces the pictures by its flow, which sharpens their mean; the second, at
// half the size, starts from that mean. floating.cpp chooses the cameras and draws the surface.
class MeanFlows {
 public:
  // Errors: Unsupported: no half-float targets.
  static Result<MeanFlows> create(gpu::Device& device);
  // Errors: GpuFailure.
  Status update(gpu::Device& device, const FloatingPictures& pictures, PictureBlend& blend);
  // Flow fields by rank, RG16F, at the last round's size, in the pictures' pixels: the mean at p resembles picture i at
  // p + flow i.
  std::vector<gpu::TextureId> flows() const { return texturesOf(rounds_.back().flows); }

 private:
  struct Round {
    std::unique_ptr<FlowSource> source;
    std::vector<PictureGroup> flows;  // by rank, at the round's size
  };
  static std::vector<gpu::TextureId> texturesOf(const std::vector<PictureGroup>& groups);

  std::vector<Round> rounds_;
  PictureGroup mean_;  // start of a round; half of the view's size
  FlowSum sum_;
};

}  // namespace fourdvt::render
